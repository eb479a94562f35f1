// How long the rows of an image take, from the normal equations of bands of rows.
#include <gtest/gtest.h>

#include <random>

#include "host/slam/tracking/readout_estimate.h"

namespace rosefusion::testing {
namespace test_readout_estimate {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

const Intrinsics kCamera{640, 480, 525, 525, 319.5, 239.5};
constexpr double kInterval = 1.0 / 30, kVariance = 5e-4;

/// Bands of rows whose own best poses are off by `off` and, by their place between -0.5 and 0.5, by that
/// share of `share` times the motion. Each holds five directions, as a view of few surfaces does.
std::vector<RefineSums> bandsOf(const Vector6& off, double share, const Vector6& motion, std::uint64_t seed,
                                double noise = 0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<RefineSums> bands(16);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const double row = (static_cast<double>(b) + 0.5) / 16 - 0.5;
    Matrix6 h = Matrix6::Zero();
    for (int i = 0; i < 5; ++i) {
      Vector6 j;
      for (double& v : j) v = normal(random);
      h += 20 * j * j.transpose();
    }
    Vector6 own = off + row * share * motion;
    for (double& v : own) v += noise * normal(random);
    const Vector6 g = -h * own;
    int entry = 0;
    for (int r = 0; r < 6; ++r)
      for (int c = r; c < 6; ++c) bands[b][shader::kRefineHessian + entry++] = h(r, c);
    for (int i = 0; i < 6; ++i) bands[b][shader::kRefineGradient + i] = g[i];
    bands[b][shader::kRefineUsable] = 100;
    bands[b][shader::kRefineRows] = 100 * ((row + 0.5) * kCamera.height - 0.5 - kCamera.cy) / kCamera.fy;
  }
  return bands;
}

Vector6 someMotion() {
  Vector6 motion;
  motion << 0.03, -0.02, 0.05, 0.04, -0.06, 0.02;
  return motion;
}

TEST(ReadoutEvidence, IsTheShareOfTheMotionThatTheRowsLieAlong) {
  Vector6 off;
  off << 0.001, 0.002, -0.001, 0.003, 0, -0.002;
  for (const double share : {0.0, 0.4, 0.9, -0.7}) {
    const ReadoutEvidence found =
        readoutEvidence(bandsOf(off, share, someMotion(), 3), someMotion(), kCamera, kVariance);
    ASSERT_GT(found.information, 0);
    EXPECT_NEAR(found.weighted / found.information, share, 0.01);
  }
}

TEST(ReadoutEvidence, ACameraAtRestAndAnEmptyViewSayNothing) {
  EXPECT_EQ(
      readoutEvidence(bandsOf(Vector6::Ones(), 1, Vector6::Zero(), 3), Vector6::Zero(), kCamera, kVariance)
          .information,
      0);
  EXPECT_EQ(readoutEvidence({}, someMotion(), kCamera, kVariance).information, 0);
  const std::vector<RefineSums> empty(16, RefineSums{});
  EXPECT_EQ(readoutEvidence(empty, someMotion(), kCamera, kVariance).weighted, 0);
}

/// After so many frames, each corrected by what was known before it.
ReadoutEstimate after(int frames, double readout, double noise) {
  ReadoutEstimate estimate;
  for (int i = 0; i < frames; ++i) {
    const double applied = estimate.seconds();
    const auto bands =
        bandsOf(Vector6::Zero(), (readout - applied) / kInterval, someMotion(), 100 + i, noise);
    estimate.add(readoutEvidence(bands, someMotion(), kCamera, kVariance), applied, kInterval);
  }
  return estimate;
}

TEST(ReadoutEstimate, FindsWhatTheFramesShareThoughTheyAreCorrectedByIt) {
  for (const double readout : {0.03, 0.012, -0.02})
    EXPECT_NEAR(after(40, readout, 0.002).seconds(), readout, 0.001) << readout;
}

TEST(ReadoutEstimate, NoneIsKnownBeforeTheFirstFrameOrWhereRowsBelongTogether) {
  EXPECT_EQ(ReadoutEstimate().seconds(), 0);
  EXPECT_EQ(after(200, 0, 0.002).seconds(), 0);
  EXPECT_EQ(after(200, 0.003, 0.002).seconds(), 0)
      << "too little to be told from what else moves with a camera";
}

TEST(ReadoutEstimate, FramesThatDifferTellLess) {
  EXPECT_GT(after(40, 0.03, 0.03).deviation(), 2 * after(40, 0.03, 0.002).deviation());
  EXPECT_EQ(after(5, 0.03, 0.1).seconds(), 0) << "of five frames that contradict each other";
}

TEST(ReadoutEstimate, WhatIsNoNumberChangesNothing) {
  ReadoutEstimate estimate = after(40, 0.03, 0.002);
  const double before = estimate.seconds();
  estimate.add({std::nan(""), 1}, 0, kInterval);
  estimate.add({1, INFINITY}, 0, kInterval);
  estimate.add({1, 1}, 0, 0);
  estimate.add({1e6, 1e6}, 0, INFINITY);
  EXPECT_EQ(estimate.seconds(), before);
}

}  // namespace test_readout_estimate
}  // namespace rosefusion::testing
