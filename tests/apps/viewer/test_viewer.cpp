// The viewer as its user sees it: a picture without a display, and a session on a display that only xdotool
// sees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/cli/exit_code.h"
#include "host/core/trajectory.h"
#include "host/settings/settings.h"
#include "host/synth/tum_writer.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/synth/rooms.h"

namespace rosefusion::testing {
namespace test_viewer {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct Outcome {
  int code = -1;
  std::string text;
};

Outcome shell(const std::string& line) {
  std::FILE* pipe = popen((line + " 2>&1").c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> chunk;
  while (const auto n = std::fread(chunk.data(), 1, chunk.size(), pipe)) outcome.text.append(chunk.data(), n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// Few particles and large voxels: frames take milliseconds.
const std::string kQuick =
    " --config paper --set 'swarm.levels=1024/16 512/8 256/4' --set tracking.templates_per_level=3"
    " --set volume.voxel_size=0.03 --set volume.truncation=0.09 --device llvmpipe";

class ViewerWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    SynthOptions options;
    options.seed = kAnyRoom;
    options.frames = 30;
    options.intrinsics = {320, 240, 320, 320, 159.5, 119.5};
    writeTumSequence(folder_ / "sequence", SynthPlan(options), false);
  }
  std::string sequence() const { return (folder_ / "sequence").string(); }
  fs::path picture(const std::string& name, int frames) {
    const fs::path file = folder_ / name;
    const Outcome outcome =
        shell(std::string(ROSEFUSION_VIEWER) + " " + sequence() + kQuick + " --screenshot " + file.string() +
              " --headless --validation --after-frames " + std::to_string(frames));
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("after " + std::to_string(frames) + " frames"));
    return file;
  }
  TemporaryFolder folder_;
};

/// A quarter of the size, blurred, so that letters and single pixels count little.
cv::Mat comparable(const fs::path& file) {
  const cv::Mat image = cv::imread(file.string());
  cv::Mat small;
  if (image.empty()) return image;
  cv::resize(image, small, {320, 200}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {5, 5}, 1.5);
  return small;
}

/// Grey levels (of 255) between two pictures, mean over the surface's part of the window.
double difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat d;
  cv::absdiff(a, b, d);
  const cv::Scalar mean = cv::mean(d(cv::Rect(0, 0, 225, 172)));
  return (mean[0] + mean[1] + mean[2]) / 3;
}

// Lavapipe's and our own rounding move edges by a pixel here and there, which is a few tenths of a grey
// level; a missing surface is more than ten.
constexpr double kTolerance = 2;

TEST_F(ViewerWindow, PictureWithoutADisplayIsTheStoredOne) {
  const fs::path taken = picture("room.png", 4);
  const fs::path stored = fs::path(ROSEFUSION_FIXTURES) / "viewer/room.png";
  const cv::Mat expected = comparable(stored), is = comparable(taken);
  ASSERT_FALSE(expected.empty()) << stored << " is missing";
  ASSERT_FALSE(is.empty());
  EXPECT_LT(difference(is, expected), kTolerance) << stored << " shows something else";

  EXPECT_GT(difference(comparable(picture("empty.png", 0)), expected), 3 * kTolerance)
      << "a picture without the surface must not pass";
}

TEST_F(ViewerWindow, WhatCannotBeShownIsSaid) {
  const Outcome missing = shell(std::string(ROSEFUSION_VIEWER) + " /nowhere --headless --screenshot " +
                                (folder_ / "x.png").string());
  EXPECT_EQ(missing.code, kExitBadInput) << missing.text;
  EXPECT_THAT(missing.text, HasSubstr("/nowhere"));
  const Outcome no_display = shell("env -u DISPLAY -u WAYLAND_DISPLAY " + std::string(ROSEFUSION_VIEWER));
  EXPECT_EQ(no_display.code, kExitDevice) << no_display.text;
  EXPECT_THAT(no_display.text, HasSubstr("--headless"));
  EXPECT_EQ(shell(std::string(ROSEFUSION_VIEWER) + " --headless").code, kExitBadInput);
}

TEST_F(ViewerWindow, ADrivenSessionLeavesItsFiles) {
  for (const char* tool : {"Xvfb", "xdotool"})
    if (shell(std::string("command -v ") + tool).code != 0)
      GTEST_SKIP() << tool << " is not installed, so that nobody can press the viewer's keys.";
  const fs::path out = folder_ / "out";
  const Outcome outcome =
      shell("bash " ROSEFUSION_VIEWER_TESTS "/drive.sh " ROSEFUSION_VIEWER " '" ROSEFUSION_DROP "' " +
            sequence() + " " + out.string() + kQuick + " --validation");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  Settings settings;
  applyYamlFile(settings, out / "settings.yaml");
  EXPECT_EQ(settings.tracking.lost_residual, 0.55);
  EXPECT_GE(readTumTrajectory(out / "trajectory.txt").size(), 4u);
  EXPECT_GT(fs::file_size(out / "mesh.ply"), 10'000u);
  const cv::Mat shot = cv::imread((out / "screenshot.png").string());
  ASSERT_FALSE(shot.empty());
  cv::Scalar mean, spread;
  cv::meanStdDev(shot(cv::Rect(0, 0, shot.cols * 2 / 3, shot.rows * 4 / 5)), mean, spread);
  EXPECT_GT(spread[0], 10) << "the picture has no surface";
}

}  // namespace test_viewer
}  // namespace rosefusion::testing
