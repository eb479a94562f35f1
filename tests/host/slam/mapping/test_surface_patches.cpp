// Turning a view so that its surfaces face the way those of the model do, on corners of three planes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <limits>

#include "host/slam/mapping/surface_patches.h"

namespace rosefusion::testing {
namespace test_surface_patches {

const Intrinsics kCamera{320, 240, 160, 160, 159.5, 119.5};

struct Plane {
  Eigen::Vector3d normal;  // off the surface, towards the origin's side
  double distance;         // n . x = -distance
};
using Corner = std::array<Plane, 3>;

/// A floor (y points down) and two walls that meet at the given angle.
Corner corner(double angle) {
  return {Plane{{0, -1, 0}, 1.2}, Plane{{0, 0, -1}, 2.5}, Plane{{-std::sin(angle), 0, std::cos(angle)}, 1.5}};
}

cv::Mat look(const Corner& planes, const Pose& world_from_camera) {
  cv::Mat depth(kCamera.height, kCamera.width, CV_32F);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const Eigen::Vector3d ray = world_from_camera.linear() * kCamera.unproject(u, v, 1);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Plane& plane : planes) {
        const double speed = plane.normal.dot(ray);
        const double z = -(plane.distance + plane.normal.dot(world_from_camera.translation())) / speed;
        if (speed < 0 && z > 0) nearest = std::min(nearest, z);
      }
      depth.at<float>(v, u) = std::isfinite(nearest) ? static_cast<float>(nearest) : 0.f;
    }
  return depth;
}

Pose pose(double yaw, double pitch, double roll) {
  Pose out = Pose::Identity();
  out.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return out;
}

std::vector<SurfaceDirection> directionsOf(const Corner& planes, const Pose& world_from_camera) {
  return dominantDirections(normalsOf(surfacePatches(look(planes, world_from_camera), kCamera)), 0.04, 5);
}

TEST(SurfaceDirections, ThePlanesOfACornerAreFound) {
  const Corner planes = corner(M_PI / 2);
  const Pose camera = pose(0.5, -0.4, 0.2);
  const auto directions = directionsOf(planes, camera);
  ASSERT_EQ(directions.size(), 3U);
  for (const Plane& plane : planes) {
    double nearest = M_PI;
    for (const SurfaceDirection& d : directions)
      nearest = std::min(nearest, std::acos(std::min(1.0, plane.normal.dot(camera.linear() * d.normal))));
    EXPECT_LT(nearest, 0.02);
  }
}

TEST(SurfaceDirections, FindsTheTurnBetweenTwoViews) {
  const Corner planes = corner(M_PI / 2);
  const Pose first = pose(0.6, -0.4, 0), second = pose(-0.1, -0.7, 0.7);
  ASSERT_GT(turnBetween(first.linear(), second.linear()), 0.7) << "more than any search from the pose covers";
  const auto rotations = rotationHypotheses(directionsOf(planes, second), directionsOf(planes, first), 48);
  double nearest = M_PI;
  for (const Eigen::Matrix3d& rotation : rotations)
    nearest = std::min(nearest, turnBetween(rotation, first.linear().transpose() * second.linear()));
  EXPECT_LT(nearest, 0.03);
}

TEST(SurfaceDirections, WallsAtAnotherAngleDoNotAgree) {
  const Pose camera = pose(0.5, 0, 0);  // level, and too near to see the floor between them
  Corner square = corner(M_PI / 2), sharp = corner(M_PI / 3);
  square[0].distance = sharp[0].distance = 100;
  ASSERT_EQ(directionsOf(square, camera).size(), 2U);
  ASSERT_EQ(directionsOf(sharp, camera).size(), 2U);
  EXPECT_FALSE(rotationHypotheses(directionsOf(square, camera), directionsOf(square, camera), 48).empty());
  EXPECT_TRUE(rotationHypotheses(directionsOf(sharp, camera), directionsOf(square, camera), 48).empty());
}

TEST(SurfaceDirections, AWallAloneSaysNothing) {
  const Corner planes = corner(M_PI / 2);
  Pose camera = pose(0, 0, 0);
  camera.translation() = Eigen::Vector3d(-3, -5, 1.9);
  const auto wall = directionsOf(planes, camera);
  ASSERT_EQ(wall.size(), 1U);
  EXPECT_TRUE(rotationHypotheses(wall, directionsOf(planes, pose(0.5, -0.4, 0)), 48).empty());
}

TEST(SurfaceDirections, NothingIsFoundWithoutDepth) {
  const cv::Mat nothing(kCamera.height, kCamera.width, CV_32F, cv::Scalar(0));
  EXPECT_TRUE(surfacePatches(nothing, kCamera).empty());
  EXPECT_TRUE(dominantDirections({}, 0.04, 5).empty());
}

}  // namespace test_surface_patches
}  // namespace rosefusion::testing
