// Speeds, smoothness, clearance and views of generated motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/core/error.h"
#include "host/synth/sequence.h"
#include "host/synth/view.h"
#include "tests/host/synth/small_options.h"

namespace rosefusion::testing {
namespace test_motion {

class SixDof : public ::testing::TestWithParam<int> {};

TEST_P(SixDof, DefaultMotionHasThePapersSpeeds) {
  const SynthPlan plan(smallOptions(GetParam(), 240));
  const MotionStatistics s = plan.statistics();
  EXPECT_NEAR(s.linear_mean, 1.68, 0.03);
  EXPECT_GT(s.linear_max, 3.8);
  EXPECT_LE(s.linear_max, 4.0);
  EXPECT_NEAR(s.angular_mean, 0.95, 0.03);
  EXPECT_GT(s.angular_max, 2.05);
  EXPECT_LE(s.angular_max, 2.2);
}

TEST_P(SixDof, KeepsItsDistanceBetweenFramesToo) {
  const SynthPlan plan(smallOptions(GetParam(), 240));
  const Trajectory& truth = plan.truth();
  for (std::size_t i = 1; i < truth.size(); ++i)
    for (const double s : {0.0, 0.25, 0.5, 0.75}) {
      const Eigen::Vector3d p = (1 - s) * truth[i - 1].world_from_camera.translation() +
                                s * truth[i].world_from_camera.translation();
      ASSERT_GE(plan.tracer().clearance(p, 1), 0.25) << i;
    }
}

TEST_P(SixDof, IsSmoothAndStartsFromRest) {
  const SynthPlan plan(smallOptions(GetParam(), 240));
  const Trajectory& truth = plan.truth();
  const auto step = [&](std::size_t i) -> Eigen::Vector3d {
    return truth[i].world_from_camera.translation() - truth[i - 1].world_from_camera.translation();
  };
  const auto turn = [&](std::size_t i) -> Eigen::Vector3d {
    const Eigen::AngleAxisd a(
        (truth[i - 1].world_from_camera.inverse() * truth[i].world_from_camera).linear());
    return a.angle() * a.axis();
  };
  EXPECT_LT(step(1).norm(), 0.01);
  EXPECT_LT(turn(1).norm(), 0.01);
  for (std::size_t i = 2; i < truth.size(); ++i) {
    ASSERT_LT((step(i) - step(i - 1)).norm() * 900, 60) << i;  // m/s^2; a cusp at 2 m/s would be 120
    ASSERT_LT((turn(i) - turn(i - 1)).norm() * 900, 25) << i;  // rad/s^2
  }
}

TEST_P(SixDof, SeesEnoughToTrack) {
  const SynthOptions options = smallOptions(GetParam(), 240);
  const SynthPlan plan(options);
  int poor = 0;
  for (const StampedPose& p : plan.truth()) {
    const ViewQuality view =
        judgeView(plan.tracer(), options.intrinsics, p.world_from_camera, options.max_depth);
    ASSERT_GT(view.valid, 0.6);
    poor += view.near > 0.2 || view.median < 0.6 || view.constraint < 0.003;
  }
  EXPECT_LT(poor, 12) << "of 240 views";
}

INSTANTIATE_TEST_SUITE_P(Seeds, SixDof, ::testing::Range(1, 7));

TEST(Motion, FasterThanThePaper) {
  for (const double fastest : {6.0, 8.0}) {
    SynthOptions options = smallOptions(3, 150);
    options.linear = {fastest / 4, 0.42 * fastest, fastest};
    options.angular = {0.8, 1.8, 4.0};
    const MotionStatistics s = SynthPlan(options).statistics();
    EXPECT_NEAR(s.linear_mean, options.linear.mean, 0.05 * fastest);
    EXPECT_LE(s.linear_max, fastest);
    EXPECT_GT(s.linear_max, 0.9 * fastest);
    EXPECT_NEAR(s.angular_mean, 1.8, 0.05);
    EXPECT_LE(s.angular_max, 4.0);
    EXPECT_GE(s.clearance, 0.25);
  }
}

TEST(Motion, LinearStaysOnOneLineAndDoesNotTurn) {
  SynthOptions options = smallOptions(2, 200);
  options.motion = Motion::Linear;
  const SynthPlan plan(options);
  const Trajectory& truth = plan.truth();
  Eigen::Vector3d far = truth[0].world_from_camera.translation();
  const Eigen::Vector3d start = far;
  for (const StampedPose& p : truth)
    if ((p.world_from_camera.translation() - start).norm() > (far - start).norm())
      far = p.world_from_camera.translation();
  const Eigen::Vector3d along = (far - start).normalized();
  int reversals = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d from_start = truth[i].world_from_camera.translation() - start;
    EXPECT_LT((from_start - from_start.dot(along) * along).norm(), 1e-6);
    EXPECT_TRUE(truth[i].world_from_camera.linear() == truth[0].world_from_camera.linear());
    if (i < 2) continue;
    const auto position = [&](std::size_t k) { return truth[k].world_from_camera.translation().dot(along); };
    reversals += (position(i) - position(i - 1)) * (position(i - 1) - position(i - 2)) < 0;
  }
  EXPECT_GE(reversals, 2);
  const MotionStatistics s = plan.statistics();
  EXPECT_NEAR(s.linear_mean, 1.68, 0.25);
  EXPECT_GT(s.linear_max, 3.5);
  EXPECT_LE(s.linear_max, 4.0);
}

TEST(Motion, RotationStaysOnTheSpot) {
  SynthOptions options = smallOptions(2, 200);
  options.motion = Motion::Rotation;
  const SynthPlan plan(options);
  for (const StampedPose& p : plan.truth())
    EXPECT_TRUE(p.world_from_camera.translation() == plan.truth()[0].world_from_camera.translation());
  EXPECT_NEAR(plan.statistics().angular_mean, 0.95, 0.03);
  EXPECT_GT(plan.statistics().angular_max, 2.0);
}

TEST(Motion, ToursComeBackLapAfterLap) {
  SynthOptions options = smallOptions(2, 1800);  // 60 s at 1.68 m/s: 101 m
  options.loops = 5;
  const SynthPlan plan(options);
  EXPECT_GE(plan.statistics().clearance, 0.25);
  EXPECT_LE(plan.statistics().linear_max, 4.0);
  // Where the camera was after 4 s it passes again in later laps.
  const Eigen::Vector3d place = plan.truth()[120].world_from_camera.translation();
  int passes = 0;
  bool near = true;
  for (std::size_t i = 120; i < plan.truth().size(); ++i) {
    const double distance = (plan.truth()[i].world_from_camera.translation() - place).norm();
    if (!near && distance < 1.0) ++passes;
    near = near ? distance < 1.5 : distance < 1.0;
  }
  EXPECT_GE(passes, 3);
}

class Replay : public ::testing::Test {
 protected:
  Replay() : file_(std::filesystem::path(::testing::TempDir()) / "rosefusion_replay.txt") {
    // 4 s around a circle of 0.4 m, y down as some devices have it, looking outwards.
    Trajectory recorded;
    for (int i = 0; i <= 120; ++i) {
      const double t = i / 30.0, angle = t * 1.5;
      Pose pose = Pose::Identity();
      pose.translation() = Eigen::Vector3d(0.4 * std::sin(angle), 0.1, 0.4 * std::cos(angle));
      pose.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
      recorded.push_back({1000 + t, pose});
    }
    writeTumTrajectory(file_, recorded);
  }
  ~Replay() override { std::filesystem::remove(file_); }
  std::filesystem::path file_;
};

TEST_F(Replay, IsTheRecordingFasterAndLevel) {
  SynthOptions options = smallOptions(1, 40);
  options.motion = Motion::Replay;
  options.replay_file = file_;
  options.replay_speed = 3;
  const SynthPlan plan(options);
  ASSERT_EQ(plan.truth().size(), 40u);
  EXPECT_NEAR(plan.statistics().linear_mean, 0.4 * 1.5 * 3, 0.02);
  EXPECT_NEAR(plan.statistics().angular_mean, 1.5 * 3, 0.02);
  EXPECT_GE(plan.statistics().clearance, 0.25);
  for (const StampedPose& p : plan.truth()) {
    EXPECT_LT(p.world_from_camera.linear()(2, 1), -0.99);  // the camera's down is the room's down
    EXPECT_NEAR(p.world_from_camera.translation().z(), plan.truth()[0].world_from_camera.translation().z(),
                1e-3);
  }
}

TEST_F(Replay, EndsWithTheRecordingOrSaysItIsUnfit) {
  SynthOptions options = smallOptions(1, 500);
  options.motion = Motion::Replay;
  options.replay_file = file_;
  options.replay_speed = 2;
  EXPECT_EQ(SynthPlan(options).truth().size(), 61u);
  options.replay_speed = 50;
  EXPECT_NO_THROW(SynthPlan{options});
  Trajectory wide = readTumTrajectory(file_);
  for (StampedPose& p : wide) p.world_from_camera.translation() *= 30;
  writeTumTrajectory(file_, wide);
  EXPECT_THROW(SynthPlan{options}, InputError);
}

TEST(Options, AbsurdOnesAreRefusedByName) {
  using ::testing::HasSubstr;
  const auto complaint = [](const auto& change) -> std::string {
    SynthOptions options = smallOptions();
    change(options);
    try {
      SynthPlan plan(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(complaint([](auto& o) { o.linear.high = 500; }), HasSubstr("--max-speed"));
  EXPECT_THAT(complaint([](auto& o) { o.linear.mean = std::nan(""); }), HasSubstr("--speed"));
  EXPECT_THAT(complaint([](auto& o) { o.linear.mean = 5; }), HasSubstr("ascend"));
  EXPECT_THAT(complaint([](auto& o) { o.angular.high = -1; }), HasSubstr("--max-angular"));
  EXPECT_THAT(complaint([](auto& o) { o.frames = 0; }), HasSubstr("--frames"));
  EXPECT_THAT(complaint([](auto& o) { o.fps = 0; }), HasSubstr("--fps"));
  EXPECT_THAT(complaint([](auto& o) { o.max_depth = 50; }), HasSubstr("--max-depth"));
  EXPECT_THAT(complaint([](auto& o) { o.intrinsics.fx = 0; }), HasSubstr("intrinsics"));
  EXPECT_THAT(complaint([](auto& o) { o.motion = Motion::Replay; }), HasSubstr("--replay"));
  EXPECT_THAT(complaint([](auto& o) { o.mesh_file = "/nowhere/room.ply"; }), HasSubstr("/nowhere/room.ply"));
}

}  // namespace test_motion
}  // namespace rosefusion::testing
