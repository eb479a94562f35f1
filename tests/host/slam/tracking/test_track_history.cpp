// What a search starts from, by what became of the frames before; no device is needed.
#include <gtest/gtest.h>

#include "host/slam/tracking/track_history.h"

namespace rosefusion::testing {
namespace test_track_history {

Pose at(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

double placeOf(const Pose& pose) {
  return pose.translation().x();
}

TrackResult costing(double cost) {
  TrackResult result;
  result.cost = cost;
  result.fit = PoseFit{};
  result.fit->observed_ratio = 1 - cost;
  return result;
}

CameraMotion by(double x, bool has_translation = true) {
  return {at(x), has_translation};
}

TEST(TrackHistory, RemembersNineCosts) {
  TrackHistory history;
  EXPECT_FALSE(history.medianCost());
  for (int i = 1; i <= 9; ++i) {
    EXPECT_FALSE(history.remembersEnough()) << i;
    history.advance(at(0), i, costing(0.1 * i));
  }
  EXPECT_TRUE(history.remembersEnough());
  EXPECT_NEAR(*history.medianCost(), 0.5, 1e-12);
  for (int i = 10; i <= 13; ++i) history.advance(at(0), i, costing(0.1));
  EXPECT_NEAR(*history.medianCost(), 0.5, 1e-12) << "0.5 to 0.9, and four of 0.1";
  EXPECT_NEAR(*history.observed_ratio, 0.9, 1e-12);
  history.advance(at(0), 14, costing(0.1));
  EXPECT_NEAR(*history.medianCost(), 0.1, 1e-12);
}

TEST(TrackHistory, MethodsWithoutCostLeaveNone) {
  TrackHistory history;
  history.advance(at(1), 0, TrackResult{});
  history.advance(at(2), 1);
  EXPECT_FALSE(history.medianCost());
  EXPECT_FALSE(history.observed_ratio);
  EXPECT_EQ(placeOf(history.last), 2);
}

TEST(TrackHistory, ALossForgetsCostsAndMotion) {
  TrackHistory history;
  for (int i = 0; i < 10; ++i) history.advance(at(0.1 * i), 0.1 * i, costing(0.2));
  ASSERT_GT(placeOf(history.motion.predict(1)), 0.95);
  history.interrupt();
  EXPECT_FALSE(history.medianCost());
  EXPECT_FALSE(history.remembersEnough());
  EXPECT_FALSE(history.observed_ratio);
  EXPECT_NEAR(placeOf(history.last), 0.9, 1e-12) << "it is where the camera was";
}

TEST(TrackHistory, OdometryAddsUpAcrossFramesWithoutPose) {
  TrackHistory history;
  history.advance(at(1), 0);
  history.addOdometry(by(0.2));
  history.addOdometry(by(0.3));
  EXPECT_NEAR(placeOf(history.withOdometry(at(9))), 1.5, 1e-12);
  history.addOdometry(by(0.1, false));
  EXPECT_NEAR(placeOf(history.withOdometry(at(9))), 9, 1e-12) << "a turn alone leaves the place";
  history.addOdometry({});
  EXPECT_NEAR(placeOf(history.withOdometry(at(7))), 7, 1e-12);
  history.addOdometry(by(0.2));
  EXPECT_NEAR(placeOf(history.withOdometry(at(7))), 7, 1e-12) << "the sum has a gap";
  history.advance(at(2), 1);
  history.addOdometry(by(0.2));
  EXPECT_NEAR(placeOf(history.withOdometry(at(7))), 2.2, 1e-12);
}

TEST(TrackHistory, ALostCameraIsExpectedWhereItsMotionLeadsForASecond) {
  TrackHistory history;
  for (int i = 0; i <= 10; ++i) history.advance(at(0.1 * i), 0.1 * i);
  history.addOdometry({});
  const TrackHistory::Expected soon = history.expectedPoses(1.3);
  ASSERT_EQ(soon.poses.size(), 2u);
  EXPECT_EQ(soon.followed, 2u);
  EXPECT_NEAR(placeOf(soon.poses[0]), 1.3, 1e-9);
  EXPECT_NEAR(placeOf(soon.poses[1]), 1, 1e-12);
  const TrackHistory::Expected late = history.expectedPoses(1 + kCarriedOn + 0.1);
  ASSERT_EQ(late.poses.size(), 1u);
  EXPECT_EQ(late.followed, 0u) << "by now it may be anywhere";
  history.advance(at(1.1), 1.1);
  history.addOdometry(by(0.4));
  const TrackHistory::Expected led = history.expectedPoses(5);
  ASSERT_EQ(led.poses.size(), 2u);
  EXPECT_EQ(led.followed, 1u) << "the odometry's";
  EXPECT_NEAR(placeOf(led.poses[0]), 1.5, 1e-9);
}

TEST(TrackHistory, ACorrectionMovesWhatIsKnown) {
  TrackHistory history;
  for (int i = 0; i <= 10; ++i) history.advance(at(0.1 * i), 0.1 * i);
  history.rebase(at(5));
  EXPECT_NEAR(placeOf(history.last), 6, 1e-12);
  EXPECT_NEAR(placeOf(history.motion.predict(1.1)), 6.1, 1e-9);
}

}  // namespace test_track_history
}  // namespace rosefusion::testing
