// What was seen to be empty, on images of a wall.
#include "host/slam/mapping/free_space.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_free_space {

const Intrinsics kCamera{320, 240, 250, 250, 159.5, 119.5};
constexpr int kWall_mm = 3000;

cv::Mat wall(int depth_mm = kWall_mm) {
  return cv::Mat(kCamera.height, kCamera.width, CV_32FC1, cv::Scalar(depth_mm / 1000.0));
}
cv::Mat withHand(cv::Mat image, int hand_mm = 400) {
  image(cv::Rect(0, 0, kCamera.width / 2, kCamera.height)).setTo(hand_mm / 1000.0);
  return image;
}
Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

class FreeSpaceOfKeyframes : public ::testing::Test {
 protected:
  void keep(const cv::Mat& image, const Pose& pose, std::size_t frame) {
    keyframes_.setLast(image, pose, frame);
    keyframes_.offer(image, pose, frame);
  }
  Keyframes keyframes_{kCamera};
  KnownFreeSpace seen_{kCamera, DepthSettings{}, keyframes_};
};

TEST_F(FreeSpaceOfKeyframes, NothingIsKnownAtFirst) {
  EXPECT_EQ(seen_.violationOfLast(wall(), at(0, 0, 0)), 0);
  EXPECT_EQ(seen_.violation(wall(), at(0, 0, 0)), 0);
}

TEST_F(FreeSpaceOfKeyframes, TheStaticSceneFromAnywhereIsNot) {
  keep(wall(), at(0, 0, 0), 0);
  EXPECT_EQ(seen_.violationOfLast(wall(), at(0, 0, 0)), 0);
  EXPECT_EQ(seen_.violationOfLast(wall(), at(0.3, -0.2, 0)), 0);
  EXPECT_EQ(seen_.violationOfLast(wall(kWall_mm - 500), at(0, 0, 0.5)), 0) << "it came nearer";
  EXPECT_EQ(seen_.violationOfLast(wall(kWall_mm + 80), at(0, 0, 0)), 0) << "noise";
  EXPECT_EQ(seen_.violationOfLast(wall(kWall_mm + 900), at(0, 0, 0)), 0)
      << "behind what was seen all is unknown";
}

TEST_F(FreeSpaceOfKeyframes, SomethingBeforeTheCameraIs) {
  keep(wall(), at(0, 0, 0), 0);
  // But for the border, about which the kept image says nothing.
  EXPECT_NEAR(seen_.violationOfLast(withHand(wall()), at(0, 0, 0)), 0.5, 0.03);
  EXPECT_NEAR(seen_.violation(withHand(wall()), at(0, 0, 0)), 0.5, 0.03);
  EXPECT_GT(seen_.violationOfLast(withHand(wall(kWall_mm - 100)), at(0, 0, 0.1)), 0.3)
      << "it moves with the camera";
  EXPECT_EQ(seen_.violationOfLast(withHand(wall()), at(20, 0, 0)), 0) << "where the kept image did not look";
}

TEST_F(FreeSpaceOfKeyframes, APoseThatIsWrongIs) {
  keep(wall(), at(0, 0, 0), 0);
  EXPECT_GT(seen_.violationOfLast(wall(), at(0, 0, -0.5)), 0.6);
}

TEST_F(FreeSpaceOfKeyframes, WhereTheKeptImageIsInvalidNothingIsKnown) {
  cv::Mat blind = wall();
  blind.setTo(0);
  keep(blind, at(0, 0, 0), 0);
  EXPECT_EQ(seen_.violationOfLast(withHand(wall()), at(0, 0, 0)), 0);
  keep(wall(), at(0, 0, 0), 0);
  EXPECT_EQ(seen_.violationOfLast(blind, at(0, 0, 0)), 0) << "no valid pixel, no share";
}

TEST_F(FreeSpaceOfKeyframes, ASurfaceThatIsLookedThroughIsMissed) {
  EXPECT_EQ(seen_.missingSurface(wall(), at(0, 0, 0)), 0);
  keep(withHand(wall(), 1500), at(0, 0, 0), 0);
  EXPECT_EQ(seen_.missingSurface(withHand(wall(), 1500), at(0, 0, 0)), 0);
  EXPECT_EQ(seen_.missingSurface(withHand(wall(), 1500 + 80), at(0, 0, 0)), 0) << "noise";
  EXPECT_NEAR(seen_.missingSurface(wall(), at(0, 0, 0)), 0.5, 0.05) << "the near half is not there";
  EXPECT_EQ(seen_.missingSurface(withHand(wall(), 700), at(0, 0, 0)), 0) << "hidden is not missing";
  EXPECT_EQ(seen_.missingSurface(wall(), at(20, 0, 0)), 0) << "nothing known should be in view";
  EXPECT_GT(seen_.missingSurface(wall(), at(0, 0, 0.5)), 0.6) << "the wall should be half a metre nearer";
}

TEST_F(FreeSpaceOfKeyframes, EarlierImagesAreRemembered) {
  keep(wall(), at(0, 0, 0), 0);
  keep(wall(), at(20, 0, 0), 1);
  EXPECT_EQ(seen_.violationOfLast(withHand(wall()), at(0, 0, 0)), 0);
  EXPECT_NEAR(seen_.violation(withHand(wall()), at(0, 0, 0)), 0.5, 0.03);
}

TEST_F(FreeSpaceOfKeyframes, ImagesMoveWithTheirFrames) {
  keep(wall(), at(0, 0, 0), 0);
  keep(wall(), at(20, 0, 0), 1);
  const std::vector<Pose> corrected{at(5, 0, 0), at(30, 0, 0)};
  keyframes_.move(corrected);
  EXPECT_EQ(seen_.violation(withHand(wall()), at(0, 0, 0)), 0);
  EXPECT_NEAR(seen_.violation(withHand(wall()), at(5, 0, 0)), 0.5, 0.05);
  EXPECT_NEAR(seen_.violationOfLast(withHand(wall()), at(30, 0, 0)), 0.5, 0.05);
}

TEST_F(FreeSpaceOfKeyframes, AGlanceForgivesADecimetre) {
  keep(wall(), at(0, 0, 0), 0);
  const auto quickScore = [&](const cv::Mat& depth, const Pose& place) {
    return seen_.quickScore(depth, std::vector<Pose>{place}).at(0);
  };
  EXPECT_EQ(quickScore(wall(), at(0, 0, -0.3)), 0);
  EXPECT_GT(seen_.violation(wall(), at(0, 0, -0.3)), 0.6);
  EXPECT_GT(quickScore(wall(), at(0, 0, -0.6)), 0.6) << "the wall seems nearer than it was seen";
  EXPECT_EQ(quickScore(wall(), at(0, 0, 0.3)), 0);
  EXPECT_GT(seen_.missingSurface(wall(), at(0, 0, 0.3)), 0.6);
  EXPECT_GT(quickScore(wall(), at(0, 0, 0.6)), 0.6) << "the wall that was seen is not there";
  EXPECT_NEAR(quickScore(withHand(wall()), at(0, 0, 0)), 0.5, 0.07);
  EXPECT_EQ(quickScore(wall(), at(20, 0, 0)), 0) << "nothing is known there";
}

}  // namespace test_free_space
}  // namespace rosefusion::testing
