// The stored example whose figures derive_ate.py works out by other means (Horn's quaternion method, in
// Python), following evo's definition of them. Copied from its output.
#include <gtest/gtest.h>

#include <filesystem>

#include "host/evaluation/trajectory_error.h"

namespace rosefusion::testing {
namespace test_evo_example {

constexpr double kTolerance = 1e-9;  // both sides hold twelve digits

TrajectoryErrors measureExample(double max_difference_s) {
  const std::filesystem::path folder = ROSEFUSION_EVALUATION_FIXTURES;
  TrajectoryErrorOptions options;
  options.max_difference_s = max_difference_s;
  return measureTrajectory(readTumTrajectory(folder / "estimate.txt"),
                           readTumTrajectory(folder / "truth.txt"), options);
}

void expectSummary(const ErrorSummary& summary, double rmse, double mean, double median, double max) {
  EXPECT_NEAR(summary.rmse, rmse, kTolerance);
  EXPECT_NEAR(summary.mean, mean, kTolerance);
  EXPECT_NEAR(summary.median, median, kTolerance);
  EXPECT_NEAR(summary.max, max, kTolerance);
}

TEST(EvoExample, EqualsTheDerivedFiguresAtEvosDefault) {
  const TrajectoryErrors errors = measureExample(0.01);
  EXPECT_EQ(errors.common_poses, 57u);
  expectSummary(errors.ate_m, 0.019784277221, 0.018091239117, 0.016199896491, 0.038608292398);
  expectSummary(errors.te_m, 0.024707337143, 0.022738405587, 0.020631982218, 0.043560494144);
  expectSummary(errors.rpe_frame_m, 0.028152634703, 0.025876940434, 0.027411277157, 0.050196518542);
  expectSummary(errors.rpe_frame_deg, 1.314076867675, 1.179223384380, 1.160989414080, 3.167218882311);
}

TEST(EvoExample, EqualsDerivedFiguresAtTheTumLimit) {
  const TrajectoryErrors errors = measureExample(0.02);
  EXPECT_EQ(errors.common_poses, 59u);
  expectSummary(errors.ate_m, 0.019975113109, 0.018319499437, 0.016507678664, 0.038561067582);
  expectSummary(errors.te_m, 0.024951756699, 0.023015162689, 0.021157135444, 0.043560494144);
  expectSummary(errors.rpe_frame_m, 0.028455551970, 0.026093194668, 0.026319170691, 0.050196518542);
  expectSummary(errors.rpe_frame_deg, 1.360588527219, 1.218947265673, 1.166770767588, 3.167218882311);
}

TEST(EvoExample, CountsTheThreeFramesThatItLeavesOut) {
  const TrajectoryErrors errors = measureExample(0.01);
  EXPECT_EQ(errors.estimate_poses, 60u);
  EXPECT_EQ(errors.lost_frames, 3u);
  EXPECT_EQ(errors.frames, 63u);
}

}  // namespace test_evo_example
}  // namespace rosefusion::testing
