// What two keyframes share, on walls whose images can be written down.
#include <gtest/gtest.h>

#include <numbers>

#include "host/slam/loop_closure/keyframe_views.h"

namespace rosefusion::testing {
namespace test_keyframe_views {

constexpr Intrinsics kCamera{160, 120, 80, 80, 79.5, 59.5};  // 90 degrees wide

cv::Mat wallAt(double metres) {
  return cv::Mat(120, 160, CV_32F, cv::Scalar(metres));
}

KeyframeViews viewsOf(const std::vector<cv::Mat>& images) {
  KeyframeViews views(kCamera);
  for (const cv::Mat& image : images) views.add(image);
  return views;
}

Pose shifted(double x, double y, double z) {
  return Eigen::Translation3d(x, y, z) * Pose::Identity();
}

Pose turned(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * Pose::Identity();
}

TEST(KeyframeViews, ShareIsWhatBothImagesHold) {
  const KeyframeViews views = viewsOf({wallAt(2), wallAt(2)});
  EXPECT_EQ(views.overlap(1, 0, Pose::Identity()), 1);
  // The image is 4 m wide there, and 3 m high.
  EXPECT_NEAR(views.overlap(1, 0, shifted(1, 0, 0)), 0.75, 0.051);
  EXPECT_NEAR(views.overlap(1, 0, shifted(-2, 1, 0)), 0.5 * 2 / 3, 0.051);
  EXPECT_EQ(views.overlap(1, 0, shifted(5, 0, 0)), 0);
  EXPECT_EQ(views.overlap(1, 0, turned(2)), 0);
}

TEST(KeyframeViews, ASurfaceElsewhereIsNotShared) {
  const KeyframeViews views = viewsOf({wallAt(2), wallAt(3)});
  EXPECT_EQ(views.overlap(1, 0, Pose::Identity()), 0) << "3 m where 2 m were seen";
  EXPECT_NEAR(views.overlap(1, 0, shifted(0, 0, -1)), 4 / 9., 0.051) << "an image of 6 m by 4.5 m";
  EXPECT_NEAR(views.overlap(1, 0, shifted(0, 0, -0.7)), 4 / 7.29, 0.051) << "off by as much as drift may be";
  EXPECT_EQ(views.overlap(1, 0, shifted(0, 0, -0.4)), 0);
  EXPECT_NEAR(views.overlap(0, 1, shifted(0, 0, 1)), 1, 0.01) << "all of the nearer image";
}

TEST(KeyframeViews, OnlyFromAboutAsFarAndFromTheSameSide) {
  const KeyframeViews views = viewsOf({wallAt(1), wallAt(2.5)});
  EXPECT_EQ(views.overlap(1, 0, shifted(0, 0, -1.5)), 0) << "2.5 times as far";
  EXPECT_EQ(views.overlap(0, 0, shifted(0, 0, 2) * turned(std::numbers::pi)), 0) << "through the wall";
}

TEST(KeyframeViews, PixelsWithoutDepthShareNothing) {
  cv::Mat half = wallAt(2);
  half.colRange(0, 80).setTo(0);
  const KeyframeViews views = viewsOf({half, wallAt(2), wallAt(0)});
  EXPECT_NEAR(views.overlap(1, 0, Pose::Identity()), 0.5, 1e-9);
  EXPECT_EQ(views.overlap(0, 1, Pose::Identity()), 1) << "of what it saw";
  EXPECT_EQ(views.overlap(2, 1, Pose::Identity()), 0);
  EXPECT_EQ(views.overlap(1, 2, Pose::Identity()), 0);
}

}  // namespace test_keyframe_views
}  // namespace rosefusion::testing
