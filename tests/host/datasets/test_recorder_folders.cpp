// Folders as Open3D's recorders, ScanNet's exporter and Stray Scanner write them, and depth in
// floating-point images.
#include <gmock/gmock.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "host/core/error.h"
#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_recorder_folders {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kAt = "0 -1 0 0.5\n1 0 0 -0.25\n0 0 1 ";  // and the distance along z

Frame frameOf(Sequence& sequence, std::size_t index) {
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence.read(index, frame, problem)) << problem;
  EXPECT_EQ(problem, "");
  return frame;
}

std::unique_ptr<Sequence> withColour(const TemporaryFolder& folder) {
  SequenceOptions options;
  options.colour = true;
  return openSequence(folder.path(), options);
}

void makeOpen3d(const TemporaryFolder& folder) {
  int n = 0;
  for (const char* number : {"000000", "000001", "000002"}) {
    folder.writeImage("depth/" + std::string(number) + ".png", depthImage(1500 + n));
    folder.writeImage("color/" + std::string(number) + ".jpg", colourImage(200));
    ++n;
  }
  folder.write("camera_intrinsic.json",
               R"({"width": 32, "height": 24, "intrinsic_matrix": [30, 0, 0, 0, 31, 0, 16, 12, 1]})");
  folder.write("trajectory.log", "0 0 1\n" + std::string(kAt) + "1\n0 0 0 1\n2 2 3\n" + kAt + "3\n0 0 0 1\n");
}

TEST(Open3dFolder, ImagesCameraAndTruth) {
  const TemporaryFolder folder;
  makeOpen3d(folder);
  const auto sequence = withColour(folder);
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "Open3D recorder");
  EXPECT_EQ(info.intrinsics, (Intrinsics{32, 24, 30, 31, 16, 12}));
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_THAT(info.warnings, IsEmpty());
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 2 / 30.0);
  const Frame frame = frameOf(*sequence, 2);
  EXPECT_EQ(cv::countNonZero(frame.depth != depthImage(1502)), 0);
  EXPECT_FALSE(frame.colour.empty());
  ASSERT_EQ(info.truth.size(), 2u) << "a frame without a pose is left out";
  EXPECT_DOUBLE_EQ(info.truth[1].timestamp, 2 / 30.0);
  EXPECT_DOUBLE_EQ(info.truth[1].world_from_camera.translation().z(), 3);
}

TEST(Open3dFolder, RedwoodsNamesHoldTheTime) {
  const TemporaryFolder folder;
  for (const char* name : {"000001-000000000000", "000002-000000033369", "000010-000000300321"})
    folder.writeImage("depth/" + std::string(name) + ".png", depthImage(1500));
  for (const char* name : {"000001-000000001000", "000003-000000301000"})
    folder.writeImage("image/" + std::string(name) + ".jpg", colourImage(200));
  folder.write("trajectory.log", "0 0 1\n" + std::string(kAt) + "1\n0 0 0 1\n");
  const auto sequence = withColour(folder);
  EXPECT_TRUE(sequence->info().intrinsics_assumed);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 0.033369);
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 0.300321);
  EXPECT_FALSE(frameOf(*sequence, 0).colour.empty());
  EXPECT_TRUE(frameOf(*sequence, 1).colour.empty()) << "the nearest colour is 30 ms away";
  EXPECT_FALSE(frameOf(*sequence, 2).colour.empty()) << "paired by time, not by number";
}

TEST(Open3dFolder, DamagedTextsAreNamed) {
  const TemporaryFolder folder;
  makeOpen3d(folder);
  folder.write("trajectory.log", "0 0 1\n" + std::string(kAt) + "1\n0 0 0 1\n9 9 9\n1 0 0 0\n0 1 0 0\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().truth.size(), 1u);
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("trajectory.log: 1 poses skipped")));
  folder.write("camera_intrinsic.json", R"({"width": 32})");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("column by column"));
}

void makeScanNet(const TemporaryFolder& folder) {
  int n = 0;
  for (const char* number : {"0", "2", "10"}) {  // 10 comes last: numbers, not letters
    folder.writeImage("depth/" + std::string(number) + ".png", depthImage(1500 + n));
    folder.writeImage("color/" + std::string(number) + ".jpg", colourImage(200, 64, 48));
    folder.write("pose/" + std::string(number) + ".txt",
                 std::string(kAt) + std::to_string(n) + "\n0 0 0 1\n");
    ++n;
  }
  folder.write("intrinsic/intrinsic_depth.txt", "30 0 16 0\n0 31 12 0\n0 0 1 0\n0 0 0 1\n");
  folder.write("intrinsic/intrinsic_color.txt", "60 0 32 0\n0 62 24 0\n0 0 1 0\n0 0 0 1\n");
}

TEST(ScanNetFolder, ImagesCameraAndTruth) {
  const TemporaryFolder folder;
  makeScanNet(folder);
  const std::string lost =
      "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n";
  folder.write("pose/2.txt", lost);
  const auto sequence = withColour(folder);
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "ScanNet folder");
  EXPECT_EQ(info.intrinsics, (Intrinsics{32, 24, 30, 31, 16, 12}));
  EXPECT_THAT(info.warnings, IsEmpty()) << "an unknown pose is none to warn of";
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 10 / 30.0);
  const Frame frame = frameOf(*sequence, 2);
  EXPECT_EQ(frame.depth.at<std::uint16_t>(0, 0), 1502);
  EXPECT_EQ(frame.colour.size(), frame.depth.size()) << "colour is brought to depth's size";
  ASSERT_EQ(info.truth.size(), 2u);
  EXPECT_DOUBLE_EQ(info.truth[1].timestamp, 10 / 30.0);
}

TEST(ScanNetFolder, ColourOfAnotherViewIsLeftOut) {
  const TemporaryFolder folder;
  makeScanNet(folder);
  folder.write("intrinsic/intrinsic_color.txt", "60 0 40 0\n0 62 24 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_FALSE(withColour(folder)->info().has_colour);
  folder.write("intrinsic/intrinsic_depth.txt", "30 0\n");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("intrinsic_depth.txt"));
}

void makeStray(const TemporaryFolder& folder) {
  cv::Mat confidence(kHeight, kWidth, CV_8UC1, cv::Scalar(2));
  confidence.at<std::uint8_t>(3, 7) = 0;
  confidence.at<std::uint8_t>(3, 8) = 1;
  for (const char* number : {"000000", "000001"}) {
    folder.writeImage("depth/" + std::string(number) + ".png", depthImage(1500));
    folder.writeImage("confidence/" + std::string(number) + ".png", confidence);
  }
  folder.write("camera_matrix.csv", "1800.0, 0.0, 960.0\n0.0, 1860.0, 720.0\n0.0, 0.0, 1.0\n");
  folder.write("odometry.csv",
               "timestamp, frame, x, y, z, qx, qy, qz, qw\n"
               "5012.25, 000000, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0\n"
               "5012.3125, 000001, 0.4, 0.5, 0.6, 0.0, 0.0, 0.70710678, 0.70710678\n");
}

TEST(StrayFolder, ScalesItsCameraAndDropsDoubtfulDepth) {
  const TemporaryFolder folder;
  makeStray(folder);
  const auto sequence = openSequence(folder.path());
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "Stray Scanner");
  EXPECT_FALSE(info.intrinsics_assumed);
  EXPECT_DOUBLE_EQ(info.intrinsics.fx, 30);
  EXPECT_DOUBLE_EQ(info.intrinsics.fy, 31);
  EXPECT_NEAR(info.intrinsics.cx, 960.5 / 60 - 0.5, 1e-9);
  EXPECT_THAT(info.warnings, IsEmpty());
  ASSERT_EQ(sequence->size(), 2u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 5012.3125);
  const Frame frame = frameOf(*sequence, 1);
  EXPECT_EQ(frame.depth.at<std::uint16_t>(3, 7), 0) << "confidence 0";
  EXPECT_EQ(frame.depth.at<std::uint16_t>(3, 8), 1500 + 8 + 40 * 3);
  ASSERT_EQ(info.truth.size(), 2u);
  const Pose& pose = info.truth[1].world_from_camera;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.4, 0.5, 0.6)));
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-6));
}

TEST(StrayFolder, DamageIsTold) {
  const TemporaryFolder folder;
  makeStray(folder);
  folder.truncate("confidence/000001.png", 0.5);
  folder.write("odometry.csv", folder.read("odometry.csv") + "5013, 000002, nan, 0, 0, 0, 0, 0, 1\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("odometry.csv: 1 line skipped (line 4")));
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(1, frame, problem));
  EXPECT_THAT(problem, HasSubstr("confidence"));
  EXPECT_NE(frame.depth.at<std::uint16_t>(3, 7), 0) << "its depths are all taken";
  folder.write("camera_matrix.csv", "1800, 0, 960\n");
  EXPECT_THAT(openingError(folder.path()), HasSubstr("camera_matrix.csv"));
}

std::string npy(const std::string& kind, const std::string& data) {
  std::string header = "{'descr': '" + kind + "', 'fortran_order': False, 'shape': (24, 32), }";
  header.resize(118 - 1, ' ');
  header += '\n';
  return "\x93NUMPY\x01" + std::string(1, '\0') + std::string("\x76\0", 2) + header + data;
}

TEST(FloatingDepth, MetresAreReadFromTiffAndNumPy) {
  cv::Mat metres;
  depthImage(1500).convertTo(metres, CV_32F, 1e-3);
  metres.at<float>(0, 1) = NAN;
  metres.at<float>(0, 2) = -1;
  metres.at<float>(0, 3) = 70;  // farther than is kept
  const std::string raw(reinterpret_cast<const char*>(metres.data), metres.total() * 4);
  for (const char* ending : {".tiff", ".npy"}) {
    const TemporaryFolder folder;
    makeOpen3d(folder);
    for (const char* number : {"000000", "000001", "000002"}) {
      folder.remove("depth/" + std::string(number) + ".png");
      const std::string name = "depth/" + std::string(number) + ending;
      if (std::string(ending) == ".npy")
        folder.write(name, npy("<f4", raw));
      else
        folder.writeImage(name, metres);
    }
    const auto sequence = openSequence(folder.path());
    const double units = sequence->info().depth_units_per_metre;
    const Frame frame = frameOf(*sequence, 0);
    ASSERT_EQ(frame.depth.type(), CV_16UC1);
    EXPECT_NEAR(frame.depth.at<std::uint16_t>(5, 7) / units, metres.at<float>(5, 7), 1e-4) << ending;
    for (const int u : {1, 2, 3}) EXPECT_EQ(frame.depth.at<std::uint16_t>(0, u), 0) << ending << u;
  }
}

TEST(FloatingDepth, MetresInOpenExrWhereOpenCvIsAllowedTo) {
  const TemporaryFolder folder;
  cv::Mat metres;
  depthImage(1500).convertTo(metres, CV_32F, 1e-3);
  try {
    if (!cv::imwrite(folder.text("depth.exr"), metres)) GTEST_SKIP() << "OpenCV was built without OpenEXR";
  } catch (const cv::Exception&) {
    GTEST_SKIP() << "OpenCV was not told to handle OpenEXR (OPENCV_IO_ENABLE_OPENEXR=1)";
  }
  for (const char* name : {"depth/0.exr", "depth/1.exr"}) folder.write(name, folder.read("depth.exr"));
  folder.write("intrinsic_depth.txt", "30 0 16\n0 31 12\n0 0 1\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_NEAR(frameOf(*sequence, 1).depth.at<std::uint16_t>(5, 7) / sequence->info().depth_units_per_metre,
              metres.at<float>(5, 7), 1e-4);
}

TEST(FloatingDepth, MillimetresInSixteenBitTiffAndNumPy) {
  const TemporaryFolder folder;
  const cv::Mat depth = depthImage(1500);
  folder.writeImage("depth/0.tiff", depth);
  folder.write("depth/1.npy",
               npy("<u2", std::string(reinterpret_cast<const char*>(depth.data), depth.total() * 2)));
  folder.write("intrinsic_depth.txt", "30 0 16\n0 31 12\n0 0 1\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().depth_units_per_metre, 1000);
  for (const std::size_t i : {0, 1}) EXPECT_EQ(cv::countNonZero(frameOf(*sequence, i).depth != depth), 0);
}

TEST(FloatingDepth, UnitsOfASequenceYamlHold) {
  const TemporaryFolder folder;
  cv::Mat millimetres;
  depthImage(1500).convertTo(millimetres, CV_32F);
  folder.writeImage("d/0.tiff", millimetres);
  folder.write("sequence.yaml",
               "intrinsics: {fx: 30, fy: 30, cx: 16, cy: 12}\ndepth_units_per_metre: 1000\nfps: 30\ndepth: "
               "d/*.tiff\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_NEAR(frameOf(*sequence, 0).depth.at<std::uint16_t>(0, 0) / sequence->info().depth_units_per_metre,
              1.5, 1e-4);
}

TEST(FloatingDepth, DamagedNumPyEndsInASentence) {
  const std::string good = npy("<u2", std::string(2 * kWidth * kHeight, '\1'));
  for (const std::string& bytes : {good.substr(0, 9), good.substr(0, 60), good.substr(0, good.size() - 1),
                                   npy("<i8", std::string(8000, 'x')),
                                   std::string(good).replace(good.find("(24, 32)"), 8, "(99999,9")}) {
    const TemporaryFolder folder;
    folder.write("depth/0.npy", bytes);
    folder.write("intrinsic_depth.txt", "30 0 16\n0 31 12\n0 0 1\n");
    EXPECT_THAT(openingError(folder.path()), HasSubstr("the NumPy array is cut short or not of one image"));
  }
}

}  // namespace test_recorder_folders
}  // namespace rosefusion::testing
