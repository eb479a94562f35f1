#include "host/evaluation/trajectory_error.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "host/evaluation/report_json.h"
#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_trajectory_error {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// 100 frames a second for three seconds: motion capture.
Trajectory denseTruth() {
  Trajectory truth;
  for (int i = 0; i <= 300; ++i)
    truth.push_back({0.01 * i, makePose({0.1 * i, std::sin(0.1 * i), 0}, 0, {1, 0, 0})});
  return truth;
}

TEST(Summarise, GivesRmseMeanMedianMax) {
  const ErrorSummary s = summarise({3, 1, 0, 10});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(110.0 / 4));
  EXPECT_DOUBLE_EQ(s.mean, 3.5);
  EXPECT_DOUBLE_EQ(s.median, 2);
  EXPECT_DOUBLE_EQ(s.max, 10);
  EXPECT_DOUBLE_EQ(summarise({5, 1, 2}).median, 2);
}

TEST(Summarise, OfNothingIsNan) {
  const ErrorSummary s = summarise({});
  EXPECT_EQ(s.count, 0u);
  EXPECT_TRUE(std::isnan(s.rmse) && std::isnan(s.mean) && std::isnan(s.median) && std::isnan(s.max));
}

TEST(TrajectoryError, RigidlyMovedTrajectoryHasNone) {
  const Trajectory truth = curve(60);
  const TrajectoryErrors e = measureTrajectory(moved(somewhere(), truth), truth);
  EXPECT_EQ(e.common_poses, 60u);
  for (const ErrorSummary* s : {&e.ate_m, &e.te_m, &e.rpe_frame_m, &e.rpe_second_m}) EXPECT_LT(s->max, 1e-12);
  EXPECT_LT(e.rpe_frame_deg.max, 1e-6);
  EXPECT_EQ(e.te_share, (std::array<double, 4>{1, 1, 1, 1}));
}

TEST(TrajectoryError, AteOfKnownNoise) {
  // Every position is off by 2 cm, up and down in turn: no rigid motion makes that better (to second order).
  const Trajectory truth = curve(600);
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    estimate[i].world_from_camera.translation().z() += i % 2 ? 0.02 : -0.02;
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_NEAR(e.ate_m.rmse, 0.02, 1e-5);
  EXPECT_NEAR(e.ate_m.mean, 0.02, 1e-5);
  EXPECT_NEAR(e.rpe_frame_m.rmse, 0.04, 1e-12);
}

TEST(TrajectoryError, AteOfGaussianNoise) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  const Trajectory truth = curve(5000);
  Trajectory estimate = moved(somewhere(), truth);
  for (StampedPose& p : estimate)
    p.world_from_camera.translation() += Eigen::Vector3d(noise(random), noise(random), noise(random));
  // Standard error of the RMSE: sigma / sqrt(2 n) a dimension, 0.06 mm in all; four of them allowed.
  EXPECT_NEAR(measureTrajectory(estimate, truth).ate_m.rmse, 0.01 * std::sqrt(3.0), 0.00025);
}

TEST(TrajectoryError, TeIsMeasuredFromTheFirstPose) {
  // The first frame is right, all others are 3 cm off: alignment would spread that out, TE must not.
  const Trajectory truth = curve(30);
  Trajectory estimate = truth;
  for (std::size_t i = 1; i < estimate.size(); ++i) estimate[i].world_from_camera.translation().x() += 0.03;
  const TrajectoryErrors in_place = measureTrajectory(estimate, truth);
  const TrajectoryErrors elsewhere = measureTrajectory(moved(somewhere(), estimate), truth);
  for (const TrajectoryErrors* e : {&in_place, &elsewhere}) {
    EXPECT_NEAR(e->per_frame[0].te_m, 0, 1e-12);
    for (std::size_t i = 1; i < 30; ++i) EXPECT_NEAR(e->per_frame[i].te_m, 0.03, 1e-12);
    EXPECT_LT(e->ate_m.rmse, 0.01) << "alignment takes the common offset away";
  }
}

TEST(TrajectoryError, TeSharesCountStrictlyByThreshold) {
  // Errors of 0, 0.5, 1.5, 3, 7 and 20 cm.
  const double offsets_m[] = {0, 0.005, 0.015, 0.03, 0.07, 0.2};
  const Trajectory truth = curve(6);
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < 6; ++i) estimate[i].world_from_camera.translation().y() += offsets_m[i];
  const auto share = measureTrajectory(estimate, truth).te_share;
  EXPECT_DOUBLE_EQ(share[0], 2.0 / 6);
  EXPECT_DOUBLE_EQ(share[1], 3.0 / 6);
  EXPECT_DOUBLE_EQ(share[2], 4.0 / 6);
  EXPECT_DOUBLE_EQ(share[3], 5.0 / 6);
}

TEST(TrajectoryError, GivenFramesWithoutAPoseAreFailures) {
  const Trajectory truth = curve(60);
  Trajectory estimate(truth.begin(), truth.begin() + 30);
  TrajectoryErrorOptions options;
  options.sequence_frames = 120;
  const TrajectoryErrors e = measureTrajectory(estimate, truth, options);
  EXPECT_EQ(e.lost_frames, 90u);
  EXPECT_DOUBLE_EQ(e.te_share[3], 0.25);
  EXPECT_LT(e.ate_m.max, 1e-12) << "lost frames have no ATE";
}

TEST(TrajectoryError, TruthAtFrameRateTellsTheLostFrames) {
  const Trajectory truth = curve(60);
  Trajectory estimate(truth.begin(), truth.begin() + 40);
  estimate.erase(estimate.begin() + 10, estimate.begin() + 15);
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_EQ(e.lost_frames, 25u);
  EXPECT_EQ(e.frames, 60u);
  EXPECT_DOUBLE_EQ(e.te_share[0], 35.0 / 60);
  EXPECT_THAT(e.frames_basis, HasSubstr("every true pose"));
}

TEST(TrajectoryError, NeighboursDoNotStandInForLostFrames) {
  // At 100 Hz the frames next to a lost one lie within the 0.02 s of the association.
  const Trajectory truth = denseTruth();
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 50);
  estimate.erase(estimate.begin() + 100);
  EXPECT_EQ(measureTrajectory(estimate, truth).lost_frames, 2u);
}

TEST(TrajectoryError, GapsTellTheLostFramesUnderDenseTruth) {
  const Trajectory truth = denseTruth();
  Trajectory estimate;
  for (std::size_t i = 0; i < truth.size(); i += 5)
    if (i < 100 || i >= 130) estimate.push_back(truth[i]);
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_EQ(e.lost_frames, 6u);
  EXPECT_EQ(e.frames, estimate.size() + 6);
  EXPECT_THAT(e.frames_basis, HasSubstr("0.05 s"));
}

TEST(TrajectoryError, LostPosesCountAsFailures) {
  const Trajectory truth = denseTruth();
  Trajectory estimate;
  for (std::size_t i = 0; i < truth.size(); i += 5) estimate.push_back(truth[i]);
  TrajectoryErrorOptions options;
  for (std::size_t i = estimate.size() - 10; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation().z() += 100;
    options.lost_timestamps.push_back(estimate[i].timestamp);
  }
  const TrajectoryErrors e = measureTrajectory(estimate, truth, options);
  EXPECT_EQ(e.lost_frames, 10u);
  EXPECT_EQ(e.common_poses, estimate.size() - 10);
  EXPECT_LT(e.ate_m.max, 1e-9);
  EXPECT_DOUBLE_EQ(e.te_share[0],
                   static_cast<double>(estimate.size() - 10) / static_cast<double>(estimate.size()));
}

TEST(TrajectoryError, EstimatesWithoutTruthAreNotJudged) {
  const Trajectory estimate = curve(60);
  const Trajectory truth(estimate.begin() + 20, estimate.begin() + 50);
  TrajectoryErrorOptions options;
  options.sequence_frames = 60;
  const TrajectoryErrors e = measureTrajectory(estimate, truth, options);
  EXPECT_EQ(e.common_poses, 30u);
  EXPECT_EQ(e.lost_frames, 0u);
  EXPECT_DOUBLE_EQ(e.te_share[0], 1);
  EXPECT_THAT(e.association, HasSubstr("30 of 60"));
}

TEST(TrajectoryError, RpeOfConstantDrift) {
  // The estimate runs away by 1 mm a frame along the camera's x axis, at 25 frames a second.
  Trajectory truth, estimate;
  for (int i = 0; i < 90; ++i) {
    truth.push_back({i / 25.0, makePose({0, 0.01 * i, 0}, 0, {1, 0, 0})});
    estimate.push_back({i / 25.0, makePose({0.001 * i, 0.01 * i, 0}, 0, {1, 0, 0})});
  }
  const TrajectoryErrors e = measureTrajectory(moved(somewhere(), estimate), truth);
  EXPECT_EQ(e.rpe_frame_m.count, 89u);
  EXPECT_NEAR(e.rpe_frame_m.rmse, 0.001, 1e-12);
  EXPECT_NEAR(e.rpe_frame_m.max, 0.001, 1e-12);
  EXPECT_EQ(e.rpe_second_m.count, 65u + 2u) << "65 whole seconds, and two whose end is less than 0.1 s short";
  EXPECT_NEAR(e.rpe_second_m.mean, 0.025, 1e-12);
  EXPECT_NEAR(e.rpe_second_deg.max, 0, 1e-6);
}

TEST(TrajectoryError, StampsMayBeFrameNumbers) {
  // The drift of the test above, with a frame lost.
  Trajectory truth, estimate;
  for (int i = 0; i < 90; ++i) {
    truth.push_back({double(i), makePose({0, 0.01 * i, 0}, 0, {1, 0, 0})});
    if (i != 40) estimate.push_back({double(i), makePose({0.001 * i, 0.01 * i, 0}, 0, {1, 0, 0})});
  }
  TrajectoryErrorOptions options;
  options.seconds_per_stamp = 1 / 25.0;
  const TrajectoryErrors e = measureTrajectory(estimate, truth, options);
  EXPECT_EQ(e.common_poses, 89u);
  EXPECT_EQ(e.lost_frames, 1u);
  EXPECT_NEAR(e.rpe_second_m.mean, 0.025, 1e-12);
  EXPECT_EQ(e.rpe_second_m.count, 66u) << "as above, but for the frame that is lost";
  EXPECT_EQ(e.per_frame[1].poses.timestamp, 1) << "stamps stay as they are";

  // Interpolated across a missing true pose: 0.08 s, two units of the stamps.
  truth.erase(truth.begin() + 10);
  options.association = Association::Interpolated;
  options.max_difference_s = 0.05;
  EXPECT_EQ(measureTrajectory(estimate, truth, options).common_poses, 89u);
}

TEST(TrajectoryError, RpeOfConstantTurn) {
  Trajectory truth, estimate;
  for (int i = 0; i < 60; ++i) {
    truth.push_back({i / 30.0, makePose({0.01 * i, 0, 0}, 0, {0, 0, 1})});
    estimate.push_back({i / 30.0, makePose({0.01 * i, 0, 0}, 0.1 * std::numbers::pi / 180 * i, {0, 0, 1})});
  }
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_NEAR(e.rpe_frame_deg.rmse, 0.1, 1e-9);
  EXPECT_NEAR(e.rpe_second_deg.rmse, 3, 1e-9);
}

TEST(TrajectoryError, PosesThatAreNotFiniteCountAsLost) {
  const Trajectory truth = curve(60);
  Trajectory estimate = truth;
  estimate[7].world_from_camera.translation().x() = kNan;
  estimate[8].world_from_camera.linear()(1, 1) = std::numeric_limits<double>::infinity();
  estimate[9].timestamp = kNan;
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_EQ(e.common_poses, 57u);
  EXPECT_EQ(e.lost_frames, 3u);
  EXPECT_LT(e.ate_m.max, 1e-12);
  EXPECT_DOUBLE_EQ(e.te_share[0], 57.0 / 60);
}

TEST(TrajectoryError, UnsortedPosesAreSorted) {
  const Trajectory truth = curve(60);
  Trajectory estimate = truth;
  std::shuffle(estimate.begin(), estimate.end(), std::mt19937(1));
  const TrajectoryErrors e = measureTrajectory(estimate, truth);
  EXPECT_EQ(e.lost_frames, 0u);
  EXPECT_LT(e.rpe_frame_m.max, 1e-12);
}

TEST(TrajectoryError, NothingInCommonIsNoError) {
  Trajectory late = curve(10);
  for (StampedPose& p : late) p.timestamp += 100;
  for (const auto& [estimate, truth] :
       {std::pair{late, curve(10)}, {Trajectory{}, curve(10)}, {late, Trajectory{}}}) {
    const TrajectoryErrors e = measureTrajectory(estimate, truth);
    EXPECT_EQ(e.common_poses, 0u);
    EXPECT_EQ(e.ate_m.count, 0u);
    EXPECT_TRUE(std::isnan(e.ate_m.rmse));
  }
  EXPECT_EQ(measureTrajectory({}, curve(10)).te_share[3], 0) << "all lost: all failed";
  EXPECT_TRUE(std::isnan(measureTrajectory({}, {}).te_share[3])) << "no frames: nothing to judge";
}

TEST(TrajectoryError, OneTwoAndThreePoses) {
  for (const std::size_t n : {1u, 2u, 3u}) {
    const TrajectoryErrors e = measureTrajectory(moved(somewhere(), curve(n)), curve(n));
    EXPECT_EQ(e.common_poses, n);
    EXPECT_LT(e.ate_m.max, 1e-7) << n;
    EXPECT_EQ(e.rpe_frame_m.count, n - 1);
    EXPECT_TRUE(isProperRotation(e.alignment.truth_from_estimate.linear()));
  }
}

TEST(TrajectoryError, InterpolatedTruthLeavesNoErrorOfTiming) {
  // Stamps half way between true ones, on a straight line at 10 m/s: nearest must err, interpolation must
  // not.
  Trajectory truth, estimate;
  for (int i = 0; i < 50; ++i) {
    truth.push_back({0.02 * i, makePose({0.2 * i, 0, 0}, 0, {1, 0, 0})});
    estimate.push_back(
        {0.02 * i + (i % 2 ? 0.008 : 0), makePose({0.2 * i + (i % 2 ? 0.08 : 0), 0, 0}, 0, {1, 0, 0})});
  }
  estimate.pop_back();
  TrajectoryErrorOptions options;
  EXPECT_GT(measureTrajectory(estimate, truth, options).ate_m.rmse, 0.03);
  options.association = Association::Interpolated;
  const TrajectoryErrors e = measureTrajectory(estimate, truth, options);
  EXPECT_EQ(e.common_poses, 49u);
  EXPECT_LT(e.ate_m.max, 1e-9);
  EXPECT_THAT(e.association, HasSubstr("interpolated"));
}

TEST(TrajectoryReport, HasTheNamesThatReportsShare) {
  const Trajectory truth = curve(40);
  const auto json = toJson(measureTrajectory(moved(somewhere(), truth), truth));
  for (const char* name :
       {"ate_rmse_m", "ate_mean_m", "ate_median_m", "ate_max_m", "te_rmse_m", "te_under_1cm", "te_under_2cm",
        "te_under_5cm", "te_under_10cm", "rpe_frame_rmse_m", "rpe_second_rmse_deg"})
    EXPECT_TRUE(json.contains(name) && json[name].is_number()) << name;
  EXPECT_EQ(json["te_under_5cm"], 1.0);
  EXPECT_EQ(json["lost_frames"], 0);
  EXPECT_NEAR(json["truth_from_estimate"][0][3].get<double>(), somewhere().inverse().translation().x(), 1e-9);
}

TEST(TrajectoryReport, WritesNullForWhatCouldNotBeMeasured) {
  EXPECT_THAT(toJson(measureTrajectory({}, {})).dump(), HasSubstr("\"ate_rmse_m\":null"));
}

}  // namespace test_trajectory_error
}  // namespace rosefusion::testing
