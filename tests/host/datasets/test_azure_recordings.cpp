// An Azure Kinect's recordings: small.mkv of tests/fixtures/recordings, written by make_azure.py.
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "host/core/error.h"
#include "host/datasets/azure/azure_calibration.h"
#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_azure_recordings {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace datasets;
namespace fs = std::filesystem;

const fs::path kSmall = fs::path(ROSEFUSION_SOURCE_DIR) / "tests/fixtures/recordings/small.mkv";
const cv::Size kSmallSize(40, 36);

std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  EXPECT_NE(at, bytes.npos);
  EXPECT_EQ(from.size(), to.size()) << "the sizes of elements must stay right";
  return bytes.replace(at, from.size(), to);
}

cv::Mat firstDepthOf(const fs::path& file, const SequenceOptions& options = {}) {
  Frame frame;
  std::string problem;
  EXPECT_TRUE(openSequence(file, options)->read(0, frame, problem)) << problem;
  return frame.depth;
}

TEST(AzureRecording, CameraStampsAndSensor) {
  const auto sequence = openSequence(kSmall);
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "Azure Kinect .mkv");
  EXPECT_EQ(info.sensor, "azure");
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_FALSE(info.intrinsics_assumed || info.depth_units_assumed);
  // The sensor has 64 x 64 pixels of this size, of which the narrow field begins at (12, 11.25).
  EXPECT_NEAR(info.intrinsics.cx, 0.512 * 64 - 12 - 0.5, 1e-9);
  EXPECT_NEAR(info.intrinsics.cy, 0.495 * 64 - 11.25 - 0.5, 1e-9);
  EXPECT_NEAR(info.intrinsics.fx, 0.4921 * 64, 1e-9);
  EXPECT_NEAR(info.intrinsics.fy, 0.4922 * 64, 1e-9);
  ASSERT_EQ(sequence->size(), 3u) << "infrared is none of them";
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(sequence->timestamp(i), 10 + 0.03 * static_cast<double>(i), 1e-9) << "the camera's own clock";
  EXPECT_THAT(info.warnings, IsEmpty());
  EXPECT_FALSE(info.has_colour);
  EXPECT_THAT(info.notes, Contains(HasSubstr("colour is of another view")));
}

TEST(AzureRecording, DepthIsUndistortedByTheRationalLens) {
  SequenceOptions bent;
  bent.intrinsics = Intrinsics{0, 0, 31.5, 31.5, 20, 18};  // the caller's: no lens
  const cv::Mat stored = firstDepthOf(kSmall, bent);
  for (int v = 0; v < stored.rows; ++v)
    for (int u = 0; u < stored.cols; ++u) ASSERT_EQ(stored.at<std::uint16_t>(v, u), 1500 + u + 40 * v);
  const Intrinsics k = openSequence(kSmall)->info().intrinsics;
  const cv::Matx33d matrix(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const std::vector<double> lens{3.1, 2.3, 8e-5, -5e-5, 0.13, 3.45, 3.35, 0.66};  // OpenCV's order
  cv::Mat map, none, expected;
  cv::initUndistortRectifyMap(matrix, lens, cv::Mat(), matrix, kSmallSize, CV_32FC2, map, none);
  const cv::Mat depth = firstDepthOf(kSmall);
  int moved = 0, missing = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const auto& from = map.at<cv::Vec2f>(v, u);
      const auto rest = [](float x) { return std::abs(x - std::floor(x) - 0.5f); };
      if (rest(from[0]) < 0.01f || rest(from[1]) < 0.01f) continue;  // between two pixels
      const cv::Point at(cvRound(from[0]), cvRound(from[1]));
      const bool inside = cv::Rect(cv::Point(), kSmallSize).contains(at);
      ASSERT_EQ(depth.at<std::uint16_t>(v, u), inside ? stored.at<std::uint16_t>(at) : 0) << u << ' ' << v;
      moved += inside && at != cv::Point(u, v);
      missing += !inside;
    }
  EXPECT_GT(moved, 100) << "or the test shows little";
}

TEST(AzureRecording, IsFoundByContent) {
  const TemporaryFolder folder;
  folder.write("recording", fileBytes(kSmall));
  EXPECT_EQ(openSequence(folder.path() / "recording")->size(), 3u);
  EXPECT_EQ(openSequence(folder.path())->size(), 3u) << "the folder with one";
}

TEST(AzureRecording, WhatIsCutIsReadUpToThere) {
  const TemporaryFolder folder;
  const std::string whole = fileBytes(kSmall);
  folder.write("cut.mkv", whole.substr(0, whole.size() - 4000));
  const auto sequence = openSequence(folder.path() / "cut.mkv");
  EXPECT_EQ(sequence->size(), 2u);
  EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("2 depth images are there")));
}

TEST(AzureRecording, ADamagedClusterCostsNoOther) {
  const TemporaryFolder folder;
  std::string bytes = fileBytes(kSmall);
  const std::string cluster = "\x1f\x43\xb6\x75";
  std::string size_lies = bytes, head_lost = bytes;
  size_lies[bytes.find(cluster) + 4 + 4] = 1;  // 16 MB
  folder.write("size.mkv", size_lies);
  EXPECT_EQ(openSequence(folder.path() / "size.mkv")->size(), 3u);
  head_lost[bytes.find(cluster)] = 0;
  folder.write("head.mkv", head_lost);
  EXPECT_EQ(openSequence(folder.path() / "head.mkv")->size(), 1u);
}

TEST(AzureRecording, DamagedOnesEndInASentence) {
  EXPECT_GT(openDamagedVariants(kSmall), 100) << "most damage must be lived with, or the test shows little";
}

TEST(AzureRecording, WhatItLacksIsNamed) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    folder.write("odd.mkv", replaced(fileBytes(kSmall), from, to));
    return openingError(folder.path() / "odd.mkv");
  };
  EXPECT_THAT(error("matroska", "webmwebm"), HasSubstr("no Matroska file"));
  EXPECT_THAT(error("b16g", "H264"), HasSubstr("b16g"));
  EXPECT_THAT(error("BrownConrady\"}, \"Purpose\": \"CALIBRATION_CameraPurposeDepth",
                    "BrownConrady\"}, \"Purpose\": \"CALIBRATION_CameraPurposeOther"),
              HasSubstr("no such camera"));
  EXPECT_THAT(error("BrownConrady", "Polynomial3K"), HasSubstr("Polynomial3K"));
  std::string unnamed = replaced(fileBytes(kSmall), "K4A_DEPTH_TRACK", "K4A_DEPTH_TRUCK");
  folder.write("named.mkv", unnamed);
  EXPECT_EQ(openSequence(folder.path() / "named.mkv")->size(), 3u) << "by the track's name";
  unnamed = replaced(unnamed, "DEPTH\x86", "COLOR\x86");
  folder.write("none.mkv", unnamed);
  EXPECT_THAT(openingError(folder.path() / "none.mkv"), HasSubstr("has no track DEPTH"));
}

LensCamera depthCamera(const std::string& model, const std::string& radius, cv::Size size) {
  const std::string json =
      R"({"CalibrationInformation": {"Cameras": [{"Purpose": "CALIBRATION_CameraPurposeDepth", "Intrinsics":
      {"ModelType": "CALIBRATION_LensDistortionModel)" +
      model + R"(", "ModelParameters": [0.5, 0.5, 0.49, 0.49, 3, 2, 0.1, 3.4, 3.3, 0.6, 0, 0, 0.02, 0.03]},
      "MetricRadius": )" +
      radius + R"(, "Rt": {"Rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Translation": [0, 0, 0]}}]}})";
  return azureDepthCamera(std::as_bytes(std::span(json.data(), json.size())), size, "calibration.json");
}

TEST(AzureCalibration, EachModeIsAPartOfTheSensor) {
  for (const int binned : {1, 2}) {
    const LensCamera narrow = depthCamera("BrownConrady", "1.74", {640 / binned, 576 / binned});
    EXPECT_NEAR(narrow.values.cx, (512 - 192) / binned - 0.5, 1e-9);
    EXPECT_NEAR(narrow.values.cy, (512 - 180) / binned - 0.5, 1e-9);
    const LensCamera wide = depthCamera("BrownConrady", "1.74", {1024 / binned, 1024 / binned});
    EXPECT_NEAR(wide.values.cx, 512 / binned - 0.5, 1e-9);
    EXPECT_NEAR(wide.values.fx, 0.49 * 1024 / binned, 1e-9);
  }
  EXPECT_THROW(depthCamera("BrownConrady", "1.74", {640, 480}), InputError);
}

TEST(AzureCalibration, TheTwoModelsDifferInTheTangentialTerm) {
  const Distortion twice = depthCamera("BrownConrady", "1.74", {640, 576}).lens;
  const Distortion once = depthCamera("Rational6KT", "1.74", {640, 576}).lens;
  const Eigen::Vector2d at(0.4, -0.3);
  EXPECT_TRUE((twice.apply(at) - once.apply(at)).isApprox(at.x() * at.y() * Eigen::Vector2d(0.03, 0.02)));
}

TEST(AzureCalibration, BeyondItsRadiusTheLensSeesNothing) {
  const Distortion narrow = depthCamera("BrownConrady", "0.5", {640, 576}).lens;
  EXPECT_TRUE(narrow.apply({0.49, 0}).allFinite());
  EXPECT_FALSE(narrow.apply({0.51, 0}).allFinite());
  const Distortion unknown = depthCamera("BrownConrady", "0", {640, 576}).lens;
  EXPECT_TRUE(unknown.apply({1.69, 0}).allFinite());
  EXPECT_FALSE(unknown.apply({1.71, 0}).allFinite());
  cv::Mat depth(576, 640, CV_16UC1, cv::Scalar(1000));
  Undistortion(narrow, depthCamera("BrownConrady", "0.5", {640, 576}).values).undistortDepth(depth);
  EXPECT_EQ(depth.at<std::uint16_t>(332, 10), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(332, 320), 1000);
}

}  // namespace test_azure_recordings
}  // namespace rosefusion::testing
