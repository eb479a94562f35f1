// Which frames become keyframes, and where those are after a correction.
#include "host/slam/mapping/keyframes.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_keyframes {

const Intrinsics kCamera{160, 120, 80, 80, 79.5, 59.5};

cv::Mat wall(double metres) {
  return cv::Mat(kCamera.height, kCamera.width, CV_32FC1, cv::Scalar(metres));
}
Pose at(double x, double turn = 0) {
  return Eigen::Translation3d(x, 0, 0) * Pose(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()));
}

TEST(Keyframes, OneIsAddedWhereNoneIsNear) {
  Keyframes keyframes(kCamera);
  EXPECT_TRUE(keyframes.offer(wall(2), at(0), 0));
  EXPECT_FALSE(keyframes.offer(wall(2), at(0.39), 1));
  EXPECT_FALSE(keyframes.offer(wall(2), at(0, 0.39), 2));
  EXPECT_TRUE(keyframes.offer(wall(2), at(0.41), 3));
  EXPECT_TRUE(keyframes.offer(wall(2), at(0, 0.41), 4));
  EXPECT_FALSE(keyframes.offer(wall(2), at(0.2), 5)) << "where it has been";
  ASSERT_EQ(keyframes.all().size(), 3u);
  EXPECT_EQ(keyframes.all()[1].frame, 3u);
  EXPECT_EQ(keyframes.all()[0].thumbnail.size(), cv::Size(40, 30));
}

TEST(Keyframes, PatchesAreWhereTheirFramesAre) {
  Keyframes keyframes(kCamera);
  keyframes.offer(wall(2), at(0), 0);
  keyframes.setLast(wall(3), at(5), 1);
  keyframes.offer(wall(3), at(5), 1);
  const std::size_t first = keyframes.all()[0].patches.size();
  const auto depthOf = [&](std::size_t i) { return keyframes.patches()[i].point.z(); };
  ASSERT_GT(first, 50u);
  ASSERT_GT(keyframes.patches().size(), first);
  EXPECT_NEAR(depthOf(0), 2, 1e-6);
  EXPECT_NEAR(depthOf(first), 3, 1e-6);
  Pose nearer = at(0);
  nearer.translation().z() = -0.5;
  keyframes.move(std::vector<Pose>{nearer, at(6)});
  EXPECT_NEAR(depthOf(0), 1.5, 1e-6);
  EXPECT_NEAR(keyframes.all()[1].world_from_camera.translation().x(), 6, 1e-12);
  EXPECT_NEAR(keyframes.last().camera_from_world.translation().x(), -6, 1e-12);
  keyframes.clear();
  EXPECT_TRUE(keyframes.patches().empty());
  EXPECT_TRUE(keyframes.last().thumbnail.empty());
}

// A frame that was integrated from the device alone.
TEST(Keyframes, WithoutItsImageItIsAPlaceToSearchAt) {
  Keyframes keyframes(kCamera);
  EXPECT_TRUE(keyframes.offer({}, at(0), 0));
  EXPECT_TRUE(keyframes.all()[0].thumbnail.empty());
  EXPECT_TRUE(keyframes.patches().empty());
}

}  // namespace test_keyframes
}  // namespace rosefusion::testing
