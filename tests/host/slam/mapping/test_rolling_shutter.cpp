// Images whose rows were exposed one after the other, against what a ray finds in a corner of two walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "host/slam/mapping/rolling_shutter.h"

namespace rosefusion::testing {
namespace test_rolling_shutter {

const Intrinsics kCamera{160, 120, 130, 130, 79.5, 59.5};
constexpr double kUnits = 10000, kReadout = 0.03;
// A quick hand: 2 m/s and 2 rad/s.
const Velocity kMotion{{1.2, -0.8, 1.4}, {1.1, -1.5, 0.8}};

/// Of the camera that far from the middle row's time.
Pose poseAfter(double seconds) {
  Pose pose = Pose::Identity();
  pose.translation() = seconds * kMotion.linear;
  pose.linear() =
      Eigen::AngleAxisd(seconds * kMotion.angular.norm(), kMotion.angular.normalized()).toRotationMatrix();
  return pose;
}

/// Two walls that meet in an edge before the camera.
double depthFrom(const Pose& pose, double u, double v) {
  const Eigen::Vector3d ray = pose.linear() * kCamera.unproject(u, v, 1);
  double nearest = 100;
  for (const Eigen::Vector3d& normal : {Eigen::Vector3d(0.6, 0.1, 0.8), Eigen::Vector3d(-0.7, 0.2, 0.7)})
    if (const double along = normal.dot(ray); along > 0)
      nearest = std::min(nearest, (2 - normal.dot(pose.translation())) / along);
  return nearest;
}

Frame imageOf(double readout) {
  Frame frame;
  frame.depth = cv::Mat(kCamera.height, kCamera.width, CV_16UC1);
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u)
      frame.depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(
          std::lround(kUnits * depthFrom(poseAfter(readout * ((v + 0.5) / kCamera.height - 0.5)), u, v)));
  return frame;
}

/// Of the depths of both, metres, the given quantile of how they differ.
double difference(const Frame& a, const Frame& b, double quantile) {
  std::vector<double> out;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const double x = a.depth.at<std::uint16_t>(v, u), y = b.depth.at<std::uint16_t>(v, u);
      if (x > 0 && y > 0) out.push_back(std::abs(x - y) / kUnits);
    }
  std::sort(out.begin(), out.end());
  return out.at(static_cast<std::size_t>(quantile * static_cast<double>(out.size() - 1)));
}

TEST(RollingShutter, RowsAreMovedToTheMiddleOnesTime) {
  const Frame rolled = imageOf(kReadout), still = imageOf(0);
  const Frame freed = withoutRollingShutter(rolled, kCamera, kUnits, kReadout, kMotion);
  EXPECT_GT(difference(rolled, still, 0.5), 0.004) << "or there is nothing to correct";
  EXPECT_LT(difference(freed, still, 0.5), 0.0002) << "two of the image's units";
  EXPECT_LT(difference(freed, still, 0.9), 0.0004);
  EXPECT_GT(cv::countNonZero(freed.depth), 0.9 * kCamera.width * kCamera.height);
}

TEST(RollingShutter, TheOtherDirectionMakesItWorse) {
  const Frame rolled = imageOf(kReadout), still = imageOf(0);
  const Frame wrong = withoutRollingShutter(rolled, kCamera, kUnits, -kReadout, kMotion);
  EXPECT_GT(difference(wrong, still, 0.5), 1.5 * difference(rolled, still, 0.5));
}

TEST(RollingShutter, ACameraAtRestKeepsItsImages) {
  Frame frame = imageOf(0);
  frame.depth.at<std::uint16_t>(30, 40) = 0;
  frame.colour = cv::Mat(frame.depth.size(), CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat before = frame.depth.clone();
  const Frame out = withoutRollingShutter(frame, kCamera, kUnits, kReadout, Velocity{});
  EXPECT_EQ(cv::countNonZero(out.depth != before), 0);
  EXPECT_EQ(cv::countNonZero(frame.depth != before), 0) << "the caller's image";
  EXPECT_EQ(out.colour.at<cv::Vec3b>(119, 159), cv::Vec3b(1, 2, 3));
}

TEST(RollingShutter, ColourGoesWithItsDepth) {
  Frame frame = imageOf(kReadout);
  frame.colour = cv::Mat(frame.depth.size(), CV_8UC3, cv::Scalar(0, 0, 0));
  for (int v = 0; v < kCamera.height; ++v)  // the depth's own digits
    for (int u = 0; u < kCamera.width; ++u) {
      const std::uint16_t z = frame.depth.at<std::uint16_t>(v, u);
      frame.colour.at<cv::Vec3b>(v, u) = {std::uint8_t(z & 255), std::uint8_t(z >> 8), 1};
    }
  const Frame out = withoutRollingShutter(frame, kCamera, kUnits, kReadout, kMotion);
  int compared = 0;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const cv::Vec3b c = out.colour.at<cv::Vec3b>(v, u);
      const int z = out.depth.at<std::uint16_t>(v, u), own = c[0] + 256 * c[1];
      if (z == 0) continue;
      ++compared;
      // The depth's change on the way is at most the camera's: 15 ms at 2 m/s, and as much by its turn.
      ASSERT_LT(std::abs(z - own) / kUnits, 0.1) << u << ' ' << v;
    }
  EXPECT_GT(compared, 10000);
}

TEST(RollingShutter, ImagesOfAnotherKindStayAsTheyAre) {
  Frame small;
  small.depth = cv::Mat(10, 20, CV_16UC1, cv::Scalar(7));
  EXPECT_EQ(withoutRollingShutter(small, kCamera, kUnits, kReadout, kMotion).depth.data, small.depth.data);
  Frame floats;
  floats.depth = cv::Mat(kCamera.height, kCamera.width, CV_32FC1, cv::Scalar(7));
  EXPECT_EQ(withoutRollingShutter(floats, kCamera, kUnits, kReadout, kMotion).depth.data, floats.depth.data);
  Frame grey = imageOf(0);
  grey.colour = cv::Mat(grey.depth.size(), CV_8UC1, cv::Scalar(9));
  EXPECT_EQ(withoutRollingShutter(grey, kCamera, kUnits, kReadout, kMotion).colour.data, grey.colour.data);
}

TEST(RollingShutter, AbsurdMotionsGiveHoles) {
  const Frame frame = imageOf(0);
  for (const double much : {1e3, 1e9, 1e300, std::nan("")}) {
    const Velocity motion{{much, 0, much}, {0, much, 0}};
    const Frame out = withoutRollingShutter(frame, kCamera, kUnits, kReadout, motion);
    EXPECT_EQ(out.depth.size(), frame.depth.size());
  }
}

}  // namespace test_rolling_shutter
}  // namespace rosefusion::testing
