#include "host/evaluation/plot.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <stdexcept>

#include "host/evaluation/trajectory_plot.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_plot {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kPngSignature = "\x89PNG\r\n\x1a\n";

bool hasGnuplot() {
  return std::system("gnuplot --version > /dev/null 2>&1") == 0;
}

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(i));
  return value;
}

class RenderPlot : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  }
  const TemporaryFolder folder_;
};

TEST_F(RenderPlot, DrawsATableInTheAskedSize) {
  renderPlot({"plot 'a.dat' using 1:2 with lines", {{"a.dat", "0 0\n1 1\n2 4\n"}}, 300, 200},
             folder_ / "p.png");
  const std::string png = contents(folder_ / "p.png");
  EXPECT_THAT(png, StartsWith(kPngSignature));
  EXPECT_EQ(bigEndian(png, 16), 300u);
  EXPECT_EQ(bigEndian(png, 20), 200u);
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(RenderPlot, RefusalsAreReportedInGnuplotsWords) {
  try {
    renderPlot({"plot 'absent.dat'", {}}, folder_ / "p.png");
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith((folder_ / "p.png").string()), HasSubstr("absent.dat")));
  }
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(RenderPlot, UnwritableFileIsNamed) {
  const auto plain = folder_.write("plain", "");
  EXPECT_THAT(inputErrorOf([&] { renderPlot({"plot x", {}}, plain / "p.png"); }), StartsWith(plain.string()));
}

TEST_F(RenderPlot, TrajectoryErrorsWithGapsAndAnOddTitle) {
  Trajectory estimate = curve(90);
  estimate.erase(estimate.begin() + 30, estimate.begin() + 45);
  plotTrajectoryErrors(measureTrajectory(estimate, curve(90)), curve(90), "it's a \"title\" with \\ and {_^}",
                       folder_ / "t.png");
  EXPECT_THAT(contents(folder_ / "t.png"), StartsWith(kPngSignature));
}

TEST_F(RenderPlot, CameraThatDoesNotMoveIsDrawn) {
  Trajectory still = curve(10);
  for (StampedPose& p : still) p.world_from_camera.translation().setZero();
  plotTrajectoryErrors(measureTrajectory(still, still), still, "still", folder_ / "s.png");
  EXPECT_THAT(contents(folder_ / "s.png"), StartsWith(kPngSignature));
}

TEST_F(RenderPlot, OneCommonPoseIsDrawn) {
  Trajectory truth = curve(1);
  truth[0].timestamp += 0.01;  // outside the span of the common poses
  plotTrajectoryErrors(measureTrajectory(curve(1), truth), truth, "one", folder_ / "o.png");
  EXPECT_THAT(contents(folder_ / "o.png"), StartsWith(kPngSignature));
}

TEST(RenderPlotWithoutGnuplot, SaysWhatToInstall) {
  const TemporaryFolder folder;
  const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
  setenv("PATH", folder.path().c_str(), 1);
  const std::string sentence = inputErrorOf([&] { renderPlot({"plot x", {}}, folder / "p.png"); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(sentence, AllOf(StartsWith((folder / "p.png").string()), HasSubstr("gnuplot is not installed"),
                              HasSubstr("gnuplot-nox")));
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(PlotTrajectoryErrors, NothingInCommonIsSaid) {
  EXPECT_THAT(inputErrorOf([] { plotTrajectoryErrors(measureTrajectory({}, {}), {}, "t", "p.png"); }),
              AllOf(StartsWith("p.png"), HasSubstr("nothing to draw")));
}

TEST(PlotQuoted, EscapesWhatGnuplotWouldRead) {
  EXPECT_EQ(plotQuoted("a\"b\\c\nd"), "\"a\\\"b\\\\c d\"");
}

}  // namespace test_plot
}  // namespace rosefusion::testing
