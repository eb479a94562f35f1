// The view moves where it is asked to, smoothly, and keeps up where it is.
#include <gtest/gtest.h>

#include "apps/viewer/view_camera.h"

namespace rosefusion::testing {
namespace test_view_camera {
using namespace viewer;

Pose at(double x, double y, double z, double turn = 0) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

bool isRigid(const Pose& pose) {
  return (pose.linear() * pose.linear().transpose()).isIdentity(1e-9) && pose.linear().determinant() > 0;
}

TEST(ViewCamera, OrbitLooksAtItsCentreWithTheWorldUpright) {
  ViewCamera view;
  view.frame({1, 0, 3}, 2);
  view.jump(Pose::Identity());
  ASSERT_TRUE(isRigid(view.pose()));
  const Intrinsics k = view.intrinsics(800, 600, {});
  const Eigen::Vector2d seen = k.project(view.pose().inverse() * Eigen::Vector3d(1, 0, 3));
  EXPECT_NEAR(seen.x(), 399.5, 1e-6);
  EXPECT_NEAR(seen.y(), 299.5, 1e-6);
  EXPECT_LT(view.pose().linear()(1, 1), 1);
  EXPECT_GT(view.pose().linear()(1, 1), 0) << "the picture's down is the world's";
  EXPECT_NEAR(view.pose().linear()(1, 0), 0, 1e-9) << "the horizon is level";
  // A sphere of that radius is seen whole.
  EXPECT_NEAR((view.pose().translation() - Eigen::Vector3d(1, 0, 3)).norm() * std::sin(std::atan(300 / k.fy)),
              2, 0.02);
}

TEST(ViewCamera, TurningUpsideDownIsNotPossible) {
  ViewCamera view;
  for (int i = 0; i < 100; ++i) view.turn(0, 0.3);
  view.jump(Pose::Identity());
  EXPECT_TRUE(isRigid(view.pose()));
  EXPECT_GE(view.pose().linear()(1, 1), 0);
}

TEST(ViewCamera, FirstPersonIsTheTrackedCamera) {
  ViewCamera view;
  view.setMode(ViewMode::FirstPerson);
  view.jump(at(1, 2, 3, 0.5));
  EXPECT_TRUE(view.pose().isApprox(at(1, 2, 3, 0.5), 1e-12));
  EXPECT_NEAR(view.intrinsics(800, 600, {640, 480, 525, 525, 319.5, 239.5}).fy, 525 * 600 / 480.0, 1e-9);
}

TEST(ViewCamera, NeverJumpsWhateverTheTrackedCameraDoes) {
  ViewCamera view;
  view.setMode(ViewMode::FirstPerson);
  view.jump(at(0, 0, 0));
  const Pose far = at(2, 0, 1, 1.0);
  double left = (far.translation() - view.pose().translation()).norm();
  for (int i = 0; i < 60; ++i) {
    const Pose before = view.pose();
    view.advance(far, 1 / 30.0);
    ASSERT_TRUE(isRigid(view.pose()));
    const double now = (far.translation() - view.pose().translation()).norm();
    EXPECT_LE(now, left);
    EXPECT_LT((view.pose().translation() - before.translation()).norm(), 0.6)
        << "a third of a second's way at most";
    left = now;
  }
  EXPECT_TRUE(view.pose().isApprox(far, 1e-9)) << "and it arrives";
}

TEST(ViewCamera, ChangingTheModeIsSmoothToo) {
  ViewCamera view;
  view.frame({0, 0, 2}, 2);
  view.jump(at(0, 0, 0));
  const Pose before = view.pose();
  view.setMode(ViewMode::Follow);
  view.advance(at(0, 0, 0), 0.01);
  EXPECT_LT((view.pose().translation() - before.translation()).norm(), 0.5);
  for (int i = 0; i < 100; ++i) view.advance(at(0, 0, 0), 0.05);
  EXPECT_TRUE((view.pose().translation() - Eigen::Vector3d(0, -0.5, -1.2)).isZero(1e-6));
}

TEST(ViewCamera, ZoomAndPanFollowTheMouse) {
  ViewCamera view;
  view.frame({0, 0, 2}, 2);
  view.jump(Pose::Identity());
  const double distance = (view.pose().translation() - Eigen::Vector3d(0, 0, 2)).norm();
  view.zoom(2);
  view.jump(Pose::Identity());
  EXPECT_NEAR((view.pose().translation() - Eigen::Vector3d(0, 0, 2)).norm(), distance / 2, 1e-9);
  const Eigen::Vector3d before = view.pose().translation();
  view.pan(0.1, 0);
  view.jump(Pose::Identity());
  EXPECT_NEAR((view.pose().translation() - before).dot(view.pose().linear().col(0)), -0.1 * distance / 2,
              1e-9);
}

}  // namespace test_view_camera
}  // namespace rosefusion::testing
