// How many frames must agree before one is told, and before one is fused.
#include "host/slam/relocalisation/pose_verification.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_pose_verification {

using Standing = TemporalVerification::Standing;
constexpr double kShare = 0.5;

std::optional<VerifiedPose> showing(double usable, bool confident = true) {
  VerifiedPose out;
  out.fit.observed_ratio = usable;
  out.high_confidence = confident;
  return out;
}

TEST(TemporalVerification, ALostCameraIsToldAtTheSecondFrameAndFusedAtTheThird) {
  TemporalVerification c;
  EXPECT_FALSE(c.isPending());
  EXPECT_EQ(c.next(showing(0.8), kShare, true, true), Standing::Tentative);
  EXPECT_TRUE(c.isPending());
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Consistent);
  EXPECT_TRUE(c.isPending());
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
  EXPECT_FALSE(c.isPending());
}

TEST(TemporalVerification, ASuddenChangeIsToldAtOnceAndFusedAtTheThird) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Consistent);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Consistent);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
}

TEST(TemporalVerification, ASecondChangeWhileOneIsAwaitedBeginsAnewAsAfterALoss) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Consistent);
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Consistent);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
}

TEST(TemporalVerification, WhileLittleIsKnownOfTheViewNothingIsFusedAndItIsToldLate) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.4), kShare, true, true), Standing::Tentative);
  for (int i = 2; i < 15; ++i) {
    EXPECT_EQ(c.next(showing(0.4), kShare, false, false),
              i < 10 ? Standing::Tentative : Standing::Consistent);
    EXPECT_FALSE(c.hasOverlap());
  }
  EXPECT_EQ(c.next(showing(0.5), kShare, false, false), Standing::Confirmed);
  // What an earlier place knew speaks for no other.
  EXPECT_EQ(c.next(showing(0.4), kShare, true, true), Standing::Tentative);
  EXPECT_FALSE(c.hasOverlap());
}

TEST(TemporalVerification, OnceOneKnewEnoughTheNextMayKnowLess) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.5), kShare, true, true), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.3), kShare, false, false), Standing::Consistent);
  EXPECT_EQ(c.next(showing(0.3), kShare, false, false), Standing::Confirmed);
}

PoseFit closeBy(double share) {
  PoseFit fit;
  fit.observed_ratio = 0.8;
  fit.inlier_ratio = share * fit.observed_ratio;
  return fit;
}

constexpr double kIntruding = 0.05;

TEST(InlierStatistics, ALostCameraMustFitAboutAsWellAsItsFramesDo) {
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

TEST(InlierStatistics, WhereFramesDifferAFoundPlaceMayDifferAsMuch) {
  InlierStatistics usual;
  for (int i = 0; i < 400; ++i) usual.add(closeBy(i % 2 ? 0.98 : 0.94));
  EXPECT_NEAR(usual.thresholds(true, kIntruding).inlier_ratio, 0.96 - 3 * 0.02, 0.002);
  EXPECT_NEAR(usual.thresholds(true, kIntruding).free_space, 0.04, 0.001);
  EXPECT_EQ(usual.thresholds(false, kIntruding).free_space, kIntrudingWhenFound * kIntruding);
}

TEST(TemporalVerification, WhatContradictsALittleIsToldAtTheThirdFrame) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.8, false), kShare, true, true), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.4, true), kShare, false, false), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Consistent)
      << "the second had high confidence";
  EXPECT_EQ(c.next(showing(0.8, true), kShare, false, false), Standing::Confirmed);
}

TEST(TemporalVerification, WithoutAFirmFrameThreeAreEnough) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.8, false), kShare, true, true), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Tentative);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Confirmed);
}

TEST(TemporalVerification, AFrameThatFitsNowhereEndsIt) {
  TemporalVerification c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, true), Standing::Tentative);
  EXPECT_EQ(c.next({}, kShare, false, false), Standing::Rejected);
  EXPECT_FALSE(c.isPending());
  c.next(showing(0.8), kShare, true, true);
  c.end();
  EXPECT_FALSE(c.isPending());
}

}  // namespace test_pose_verification
}  // namespace rosefusion::testing
