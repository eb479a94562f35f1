// Poses that depth left open for a while, between poses that it held.
#include "host/slam/mapping/open_stretches.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rosefusion::testing {
namespace test_open_stretches {

constexpr std::size_t kFrames = 40, kFirst = 20, kPast = 25;
constexpr double kSeconds = 1.0 / 30;

/// 2 to 4 m/s with changes of up to 12 m/s^2, turning.
Pose truthAt(double t) {
  Pose pose = Pose::Identity();
  pose.translation() << 3 * t, 0.3 * std::sin(6 * t), 0.1 * std::cos(5 * t);
  pose.linear() = Eigen::AngleAxisd(0.5 * std::sin(4 * t), Eigen::Vector3d(1, 2, 0.5).normalized()).matrix();
  return pose;
}

/// Millimetres, but a metre along `open`, a direction of moved()'s steps.
OpenStretches::Covariance covariance(const Vector6& open) {
  return 1e-6 * OpenStretches::Covariance::Identity() + open * open.transpose();
}

class OpenStretch : public ::testing::Test {
 protected:
  /// The truth, with `slide` along `open` in the stretch, growing and then gone.
  void follow(const Vector6& open, double slide, double second = kSeconds) {
    for (std::size_t i = 0; i < kFrames; ++i) {
      const double t = static_cast<double>(i) * second + (i % 3 == 0 ? 0.2 * second : 0);
      truth_.push_back({t, truthAt(t)});
      told_.push_back(truth_.back());
      const bool is_open = i >= kFirst && i < kPast;
      if (is_open) {
        const double grown =
            slide * static_cast<double>(i - kFirst + 1) / static_cast<double>(kPast - kFirst);
        told_.back().world_from_camera = moved(told_.back().world_from_camera, grown * open);
      }
      if (stretches_.add(told_, is_open ? covariance(open) : covariance(Vector6::Zero()))) closed_ = i;
    }
  }
  double shiftAt(std::size_t i) const {
    return shiftBetween(told_[i].world_from_camera, truth_[i].world_from_camera);
  }
  double turnAt(std::size_t i) const {
    return turnBetween(told_[i].world_from_camera, truth_[i].world_from_camera);
  }

  OpenStretches stretches_{0.005};
  Trajectory told_, truth_;
  std::size_t closed_ = 0;
};

TEST_F(OpenStretch, IsCorrectedAtTheSecondHeldPose) {
  follow(Vector6::Unit(0), 0.14);
  EXPECT_EQ(closed_, kPast + 1);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const bool is_open = i >= kFirst && i < kPast;
    EXPECT_LE(shiftAt(i), is_open ? 0.005 : 0) << "pose " << i;
    EXPECT_LE(turnAt(i), is_open ? 0.002 : 0) << "pose " << i;
  }
}

TEST_F(OpenStretch, OfATurnIsCorrectedToo) {
  follow(Vector6::Unit(4), 0.1);
  for (std::size_t i = kFirst; i < kPast; ++i) {
    EXPECT_LE(turnAt(i), 0.01) << "pose " << i;
    EXPECT_LE(shiftAt(i), 0.003) << "pose " << i;
  }
}

// A direction across the axes, as a wall's is.
TEST_F(OpenStretch, MovesAlongTheOpenDirectionAlone) {
  Vector6 along = Vector6::Zero();
  along.head<3>() = Eigen::Vector3d(1, 0, 2).normalized();
  follow(along, 0.14);
  for (std::size_t i = kFirst; i < kPast; ++i) {
    const Eigen::Vector3d off =
        told_[i].world_from_camera.translation() - truth_[i].world_from_camera.translation();
    EXPECT_LE(std::abs(off.dot(Eigen::Vector3d(2, 0, -1).normalized())), 0.002) << "pose " << i;
    EXPECT_LE(off.norm(), 0.005) << "pose " << i;
  }
}

TEST_F(OpenStretch, StaysAsItWasToldInHeldDirections) {
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double t = static_cast<double>(i) * kSeconds;
    told_.push_back({t, truthAt(t)});
    if (i == kFirst) told_.back().world_from_camera.translation().y() += 0.02;  // a jolt, measured well
    stretches_.add(told_, covariance(i == kFirst ? Vector6(Vector6::Unit(0)) : Vector6::Zero()));
  }
  const Pose truth = truthAt(kFirst * kSeconds);
  EXPECT_GT(told_[kFirst].world_from_camera.translation().y() - truth.translation().y(), 0.015);
}

TEST_F(OpenStretch, NeedsPosesBeforeAndAfter) {
  for (const int open : {0, 2}) {  // of the second, three held poses before tell not how a motion changes
    told_.clear();
    stretches_.clear();
    for (int i = 0; i < (open == 0 ? 30 : 6); ++i) {
      told_.push_back({i * kSeconds, truthAt(i * kSeconds)});
      EXPECT_FALSE(
          stretches_.add(told_, covariance(i == open ? Vector6(Vector6::Unit(0)) : Vector6::Zero())));
    }
  }
}

TEST(MotionChange, IsThatOfTheHeldPoses) {
  Trajectory trajectory;
  for (int i = 0; i < 60; ++i) trajectory.push_back({i * kSeconds, truthAt(i * kSeconds)});
  const MotionChange quiet = motionChange(trajectory, {});
  EXPECT_GT(quiet.shift, 0.5);
  EXPECT_LT(quiet.shift, 12);
  trajectory[30].world_from_camera.translation().x() += 5;
  const MotionChange with_open = motionChange(trajectory, {{30, {}}});
  EXPECT_NEAR(with_open.shift, quiet.shift, 0.3 * quiet.shift);
}

}  // namespace test_open_stretches
}  // namespace rosefusion::testing
