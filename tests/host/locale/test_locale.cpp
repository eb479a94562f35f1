// Files and settings mean the same whatever the program's locale is.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "host/core/number_text.h"
#include "host/datasets/inspection.h"
#include "host/evaluation/report_json.h"
#include "host/export/mesh_io.h"
#include "host/settings/settings.h"
#include "host/synth/tum_writer.h"
#include "rosefusion/reconstructor.h"
#include "tests/host/locale/foreign_locale.h"

namespace rosefusion::testing {
namespace test_locale {

using ::testing::HasSubstr;
using ::testing::Not;

/// The three locales differ in decimal sign, grouping and what letters become.
class Locale : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!foreign_.available())
      GTEST_SKIP() << "localedef cannot make " << GetParam() << "; install locales (Debian) to run this.";
  }
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  std::string read(const std::string& name) {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  ForeignLocale foreign_{GetParam()};
  TemporaryFolder folder_;
};

TEST_P(Locale, IsSet) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", 1.5);
  EXPECT_STREQ(text, "1,5") << "else nothing is tried here";
}

TEST_P(Locale, Numbers) {
  EXPECT_EQ(parseNumber("1234.5"), 1234.5);
  EXPECT_EQ(parseNumber("+1e-3"), 1e-3);
  EXPECT_EQ(parseNumber("1,5"), std::nullopt);
  EXPECT_EQ(parseNumber(""), std::nullopt);
  EXPECT_EQ(parseNumber("+-1"), std::nullopt);
  EXPECT_EQ(parseNumber(" 1"), std::nullopt);
  EXPECT_EQ(parseNumber("-1e999"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parseNumber("1e-999"), 0);
  EXPECT_TRUE(std::isnan(parseNumber("NaN").value()));
  EXPECT_EQ(printed("%.2f %d", 1234.5, 1234), "1234.50 1234");
  EXPECT_EQ(lowered("FREIBURG1_I"), "freiburg1_i") << "the Turkish i has no dot";
  TextStream stream;
  stream << 1234567 << ' ' << 0.5;
  EXPECT_EQ(stream.str(), "1234567 0.5");
}

TEST_P(Locale, SettingsComeBackAsTheyWere) {
  const Settings preset = loadSettings("default");
  const std::string yaml = toYaml(preset);
  EXPECT_THAT(yaml, HasSubstr("noise_growth: 0.0019 "));
  EXPECT_THAT(yaml, HasSubstr("10240/32"));
  Settings read = loadSettings("paper");
  applyYamlText(read, yaml, "text");
  EXPECT_EQ(toYaml(read), yaml);
  applyAssignment(read, "volume.voxel_size=0.0125");
  EXPECT_EQ(read.volume.voxel_size, 0.0125);
}

TEST_P(Locale, Trajectories) {
  write("in.txt", "1305031229.528784 1.25 -0.5 1e-3 0 0 0 1\n");
  const Trajectory trajectory = readTumTrajectory(folder_ / "in.txt");
  ASSERT_EQ(trajectory.size(), 1u);
  EXPECT_EQ(trajectory[0].world_from_camera.translation(), Eigen::Vector3d(1.25, -0.5, 1e-3));
  writeTumTrajectory(folder_ / "out.txt", trajectory);
  EXPECT_THAT(read("out.txt"), HasSubstr("1305031229.528784 1.250000000 -0.500000000 0.001000000 "));
}

TEST_P(Locale, Sequences) {
  const cv::Mat image(24, 32, CV_16UC1, cv::Scalar(1500));
  for (const char* name : {"1305031229.50", "1305031229.75"}) {
    std::filesystem::create_directories(folder_ / "depth");
    cv::imwrite((folder_ / ("depth/" + std::string(name) + ".png")).string(), image);
  }
  write("depth.txt", "1305031229.50 depth/1305031229.50.png\n1305031229.75 depth/1305031229.75.png\n");
  write("calibration.txt", "30.25 30.5 15.5 11.5\n");
  write("groundtruth.txt", "1305031229.50 0.5 0 0 0 0 0 1\n1305031229.75 0.75 0 0 0 0 0 1\n");
  const auto tum = openSequence(folder_.path());
  EXPECT_EQ(tum->info().intrinsics.fx, 30.25);
  EXPECT_EQ(tum->timestamp(1) - tum->timestamp(0), 0.25);
  EXPECT_EQ(tum->info().truth[1].world_from_camera.translation().x(), 0.75);
  write("sequence.yaml",
        "intrinsics: {fx: 30.25, fy: 30.5, cx: 15.5, cy: 11.5, width: 32, height: 24}\n"
        "depth_units_per_metre: 6553.5\ndepth: depth/*.png\nfps: 12.5\n");
  const auto described = openSequence(folder_.path());
  EXPECT_EQ(described->info().intrinsics.fy, 30.5);
  EXPECT_EQ(described->info().depth_units_per_metre, 6553.5);
  EXPECT_EQ(described->timestamp(1), 1 / 12.5);
}

TEST_P(Locale, Meshes) {
  write("mesh.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0.5 0 0\n1.75 0 0\n0 +0.25 0\n3 0 1 2\n");
  write("mesh.obj", "v 0.5 0 0\nv 1.75 0 0\nv 0 0.25 0\nf 1 2 3\n");
  for (const char* name : {"mesh.ply", "mesh.obj"}) {
    const TriangleMesh mesh = readMesh(folder_ / name);
    ASSERT_EQ(mesh.vertices.size(), 3u) << name;
    EXPECT_EQ(mesh.vertices[1].x(), 1.75f) << name;
    EXPECT_EQ(mesh.vertices[2].y(), 0.25f) << name;
  }
}

TEST_P(Locale, GeneratedSequencesAreTheSame) {
  SynthOptions options;
  options.frames = 3;
  options.intrinsics = {64, 48, 32.25, 32.25, 31.5, 23.5};
  writeTumSequence(folder_ / "s", SynthPlan(options), false);
  EXPECT_THAT(read("s/calibration.txt"), HasSubstr("32.25 32.25 31.5 23.5"));
  EXPECT_THAT(read("s/depth.txt"), Not(HasSubstr(",")));
  const auto sequence = openSequence(folder_ / "s");
  EXPECT_EQ(sequence->size(), 3u);
  const Inspection inspection = inspectSequence(*sequence);
  EXPECT_TRUE(inspection.usable());
  EXPECT_EQ(toJson(TrajectoryErrors{}).count("te_under_5cm"), 1u);
}

TEST_P(Locale, TheLibraryReconstructs) {
  Options options;
  options.preset = "paper";
  options.settings = {{"swarm.levels", "1024/16 512/8 256/4"},
                      {"tracking.templates_per_level", "3"},
                      {"volume.voxel_size", "0.03"},
                      {"volume.truncation", "0.09"}};
  Reconstructor reconstructor({160, 120, 80.5, 80.5, 79.5, 59.5, 1000}, options);
  const std::vector<std::uint16_t> depth(160 * 120, 1500);
  EXPECT_NE(reconstructor.process({depth, 0.0, {}}).status, Status::Lost);
}

INSTANTIATE_TEST_SUITE_P(Locales, Locale, ::testing::Values("de_DE", "tr_TR", "fr_FR"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace test_locale
}  // namespace rosefusion::testing
