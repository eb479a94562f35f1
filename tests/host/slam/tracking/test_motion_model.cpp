// The motion model: constant velocities are predicted, and forgotten where nothing speaks for them.
#include <gtest/gtest.h>

#include "host/slam/tracking/motion_model.h"

namespace rosefusion::testing {
namespace test_motion_model {

// Some double-precision operations on metres and radians.
constexpr double kExact = 1e-12;

/// A camera that moves at a constant velocity in the world and turns at a constant one about its own centre.
Pose moving(double timestamp) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0.3, -0.2, 1) + timestamp * Eigen::Vector3d(1.5, -0.5, 0.8);
  pose.linear() = (Eigen::AngleAxisd(timestamp * 2.5, Eigen::Vector3d(1, -2, 0.5).normalized()) *
                   Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

double distance(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(MotionModel, KnowsNothingBeforeTheFirstPose) {
  EXPECT_EQ(MotionModel().predict(3).matrix(), Pose::Identity().matrix());
}

TEST(MotionModel, StaysAtTheFirstPose) {
  MotionModel model;
  model.add(moving(0.1), 5);
  for (const double timestamp : {4.0, 5.0, 5.03, 50.0})
    EXPECT_EQ(model.predict(timestamp).matrix(), moving(0.1).matrix());
}

TEST(MotionModel, PredictsConstantVelocities) {
  MotionModel model;
  for (int i = 0; i < 20; ++i) {
    const double timestamp = i / 30.0;
    if (i >= 2) {
      EXPECT_LT(distance(model.predict(timestamp), moving(timestamp)), kExact) << "frame " << i;
    }
    model.add(moving(timestamp), timestamp);
  }
}

TEST(MotionModel, PredictsAcrossUnequalTimeSteps) {
  const double timestamps[] = {0, 0.033, 0.05, 0.15, 0.151, 0.3, 0.45, 0.46, 0.65};
  MotionModel model;
  for (std::size_t i = 0; i < std::size(timestamps); ++i) {
    // A short step before a long one multiplies its rounding: 0.149 s over 0.001 s here.
    if (i >= 2) {
      EXPECT_LT(distance(model.predict(timestamps[i]), moving(timestamps[i])), 200 * kExact) << i;
    }
    model.add(moving(timestamps[i]), timestamps[i]);
  }
  EXPECT_GT(distance(model.predict(0.7), moving(0.65)), 0.05) << "it must move for this to mean something";
  // The same poses at other times are another velocity.
  MotionModel slow;
  slow.add(moving(0), 0);
  slow.add(moving(0.05), 0.1);
  EXPECT_LT(distance(slow.predict(0.2), moving(0.1)), kExact);
}

TEST(MotionModel, ACameraAtRestIsPredictedToRest) {
  MotionModel model;
  model.add(moving(0.1), 0);
  model.add(moving(0.1), 0.03);
  EXPECT_LT(distance(model.predict(0.06), moving(0.1)), kExact);
}

TEST(MotionModel, TimestampsThatDoNotGrowStartAnew) {
  for (const double second : {1.0, 0.9, -5.0}) {
    MotionModel model;
    model.add(moving(0), 0.97);
    model.add(moving(0.03), 1);
    model.add(moving(0.06), second);
    EXPECT_EQ(model.predict(second + 0.03).matrix(), moving(0.06).matrix()) << second;
    model.add(moving(0.09), second + 0.03);  // and from there on as ever
    EXPECT_LT(distance(model.predict(second + 0.06), moving(0.12)), kExact) << second;
  }
}

TEST(MotionModel, APredictionForThePastStaysAtTheLastPose) {
  MotionModel model;
  model.add(moving(0), 0);
  model.add(moving(0.03), 0.03);
  for (const double timestamp : {0.03, 0.01, -1.0})
    EXPECT_LT(distance(model.predict(timestamp), moving(0.03)), kExact);
}

TEST(MotionModel, KnowsWhenFramesAreMissing) {
  MotionModel model;
  EXPECT_FALSE(model.isInterrupted(10));
  model.add(moving(0), 0);
  EXPECT_FALSE(model.isInterrupted(10)) << "one pose tells of no usual interval";
  model.add(moving(0.03), 0.03);
  EXPECT_FALSE(model.isInterrupted(0.06));
  EXPECT_FALSE(model.isInterrupted(0.23)) << "a few frames left out, too short to go anywhere";
  EXPECT_TRUE(model.isInterrupted(0.4));

  MotionModel slow;  // a frame a second is what this camera gives
  slow.add(moving(0), 0);
  slow.add(moving(1), 1);
  EXPECT_FALSE(slow.isInterrupted(3));
  EXPECT_TRUE(slow.isInterrupted(7));
}

TEST(MotionModel, LongGapsAreNotBridged) {
  MotionModel model;  // two poses a second apart say nothing about now
  model.add(moving(0), 0);
  model.add(moving(1), 1);
  EXPECT_EQ(model.predict(1.03).matrix(), moving(1).matrix());

  MotionModel lost;  // a velocity is carried on for a while, then no further
  lost.add(moving(0), 0);
  lost.add(moving(0.03), 0.03);
  EXPECT_LT(distance(lost.predict(0.2), moving(0.2)), 10 * kExact);
  const Pose late = lost.predict(10);
  EXPECT_EQ(late.matrix(), lost.predict(1).matrix());
  const double carried = (late.translation() - moving(0.03).translation()).norm();
  const double speed = (moving(1).translation() - moving(0).translation()).norm();
  EXPECT_GT(carried, 0.1 * speed);
  EXPECT_LT(carried, 0.5 * speed);
  EXPECT_LT(distance(lost.predict(0.6, 1), moving(0.6)), 100 * kExact) << "as long as is asked for";
  EXPECT_NEAR(lost.secondsSince(0.53), 0.5, 1e-9);
  EXPECT_GT(MotionModel().secondsSince(0.53), 1e9);
}

TEST(MotionModel, ForgottenVelocitiesAreNotUsed) {
  MotionModel model;
  model.add(moving(0), 0);
  model.add(moving(0.03), 0.03);
  model.forget();
  model.add(moving(0.06), 0.06);
  EXPECT_EQ(model.predict(0.09).matrix(), moving(0.06).matrix()) << "one pose is no motion";
  model.add(moving(0.09), 0.09);
  EXPECT_LT(distance(model.predict(0.12), moving(0.12)), kExact);
}

TEST(MotionModel, ACorrectedWorldTakesTheMotionAlong) {
  MotionModel model;
  model.add(moving(0), 0);
  model.add(moving(0.03), 0.03);
  const Pose new_from_old_world = moving(2);
  model.rebase(new_from_old_world);
  EXPECT_LT(distance(model.predict(0.06), new_from_old_world * moving(0.06)), 10 * kExact);
}

TEST(MotionModel, PredictedRotationsAreRotations) {
  MotionModel model;
  for (int i = 0; i < 200; ++i) {
    const double timestamp = i / 30.0;
    const Pose predicted = model.predict(timestamp);
    const Eigen::Matrix3d product = predicted.linear() * predicted.linear().transpose();
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), kExact) << i;
    model.add(i < 2 ? moving(timestamp) : predicted, timestamp);  // feeds on its own predictions
  }
}

}  // namespace test_motion_model
}  // namespace rosefusion::testing
