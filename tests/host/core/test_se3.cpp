// Distances between poses, and poses moved by small steps.
#include "host/core/se3.h"

#include <gtest/gtest.h>

#include <numbers>

namespace rosefusion::testing {
namespace test_se3 {

constexpr double kExact = 1e-12;

Pose somePose() {
  Pose pose(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.translation() << 1, -2, 3;
  return pose;
}

Vector6 step(const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) {
  Vector6 out;
  out << shift, turn;
  return out;
}

TEST(RotationAngle, IsTheAngleBetweenZeroAndPi) {
  EXPECT_DOUBLE_EQ(rotationAngle(Pose::Identity()), 0);
  for (const double angle : {1e-6, 0.3, 2.0, std::numbers::pi - 1e-6, std::numbers::pi}) {
    const Eigen::AngleAxisd turn(angle, Eigen::Vector3d(1, -2, 3).normalized());
    EXPECT_NEAR(rotationAngle(Pose(turn)), angle, 1e-9);
    EXPECT_NEAR(rotationAngle(Pose(turn.inverse())), angle, 1e-9);
  }
}

TEST(Canonical, IsTheSameRotationWithPositiveW) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(-0.5, 0.1, -0.7, 0.2).normalized();
  const Eigen::Quaterniond c = canonical(q);
  EXPECT_GT(c.w(), 0);
  EXPECT_TRUE(c.toRotationMatrix().isApprox(q.toRotationMatrix(), 1e-15));
  EXPECT_EQ(canonical(c).coeffs(), c.coeffs());
}

TEST(Distance, OfShiftAndTurnIsTheSameEitherWay) {
  const Pose a = somePose(), b = moved(a, step({0.3, 0, -0.4}, {0, 0.2, 0}));
  EXPECT_NEAR(shiftBetween(a, b), 0.5, kExact);
  EXPECT_NEAR(shiftBetween(b, a), 0.5, kExact);
  EXPECT_NEAR(turnBetween(a, b), 0.2, kExact);
  EXPECT_NEAR(turnBetween(b, a), 0.2, kExact);
  EXPECT_NEAR(turnBetween(Eigen::Matrix3d(a.linear()), Eigen::Matrix3d(b.linear())), 0.2, kExact);
  EXPECT_TRUE(areNear(a, b, 0.51, 0.21));
  EXPECT_FALSE(areNear(a, b, 0.49, 0.21));
  EXPECT_FALSE(areNear(a, b, 0.51, 0.19));
}

// Shifts and turns are along axes of the world, and the camera turns about its own centre.
TEST(Moved, ShiftsInTheWorldAndTurnsAboutTheCamera) {
  const Pose out = moved(somePose(), step({0.1, 0.2, 0.3}, {0, 0, std::numbers::pi / 2}));
  EXPECT_TRUE(out.translation().isApprox(Eigen::Vector3d(1.1, -1.8, 3.3), kExact));
  const Eigen::Vector3d x = somePose().linear() * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(
      (out.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(-x.y(), x.x(), x.z()), kExact));
  EXPECT_TRUE(moved(somePose(), Vector6::Zero()).isApprox(somePose(), kExact));
}

TEST(Moved, DifferenceIsTheStepBetween) {
  const Vector6 way = step({0.1, -0.2, 0.05}, {0.3, -0.1, 0.7});
  EXPECT_TRUE(difference(somePose(), moved(somePose(), way)).isApprox(way, kExact));
  EXPECT_NEAR(difference(somePose(), somePose()).norm(), 0, kExact);
  const Eigen::AngleAxisd turn = turnInWorld(somePose(), moved(somePose(), way));
  EXPECT_TRUE((turn.angle() * turn.axis()).isApprox(way.tail<3>(), kExact));
}

}  // namespace test_se3
}  // namespace rosefusion::testing
