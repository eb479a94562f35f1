// What a pose must show after frames that fitted as they did.
#include "host/slam/relocalisation/pose_verification.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_pose_verification {

PoseFit closeBy(double share) {
  PoseFit fit;
  fit.observed_ratio = 0.8;
  fit.inlier_ratio = share * fit.observed_ratio;
  return fit;
}

constexpr double kIntruding = 0.05;

TEST(InlierStatistics, ALostCameraMustFitAsItsFramesDo) {
  InlierStatistics usual;
  const AcceptanceThresholds otherwise = usual.thresholds(false, kIntruding);
  EXPECT_EQ(usual.thresholds(true, kIntruding).inlier_ratio, otherwise.inlier_ratio)
      << "nothing is usual yet";
  EXPECT_EQ(usual.thresholds(true, kIntruding).free_space, otherwise.free_space);
  for (int i = 0; i < 20; ++i) usual.add(closeBy(0.99));
  EXPECT_NEAR(usual.thresholds(true, kIntruding).inlier_ratio, 0.97, 1e-6);
  EXPECT_EQ(usual.thresholds(false, kIntruding).inlier_ratio, otherwise.inlier_ratio)
      << "it may see what is new";
  usual.add(PoseFit{});
  EXPECT_NEAR(usual.thresholds(true, kIntruding).inlier_ratio, 0.97, 1e-6)
      << "a frame that knows nothing says nothing";
  for (int i = 0; i < 400; ++i) usual.add(closeBy(0.5));
  EXPECT_EQ(usual.thresholds(true, kIntruding).inlier_ratio, otherwise.inlier_ratio)
      << "bad tracking is no standard";
  EXPECT_EQ(usual.thresholds(true, kIntruding).free_space, kIntruding);
}

TEST(InlierStatistics, ThresholdsWidenWithTheFramesSpread) {
  InlierStatistics usual;
  for (int i = 0; i < 400; ++i) usual.add(closeBy(i % 2 ? 0.98 : 0.94));
  EXPECT_NEAR(usual.thresholds(true, kIntruding).inlier_ratio, 0.96 - 3 * 0.02, 0.002);
  EXPECT_NEAR(usual.thresholds(true, kIntruding).free_space, 0.04, 0.001);
  EXPECT_EQ(usual.thresholds(false, kIntruding).free_space, kIntrudingWhenFound * kIntruding);
}

}  // namespace test_pose_verification
}  // namespace rosefusion::testing
