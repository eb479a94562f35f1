// How many frames must agree before one is told, and before one is fused.
#include "host/belief.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace {

using Standing = Confirmation::Standing;
constexpr double kShare = 0.5;

std::optional<Believed> showing(double usable, bool firm = true) {
  Believed out;
  out.fit.usable = usable;
  out.firm = firm;
  return out;
}

TEST(Confirmation, ALostCameraIsToldAtTheSecondFrameAndFusedAtTheThird) {
  Confirmation c;
  EXPECT_FALSE(c.isAwaited());
  EXPECT_EQ(c.next(showing(0.8), kShare, true, true), Standing::Supposed);
  EXPECT_TRUE(c.isAwaited());
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Agreeing);
  EXPECT_TRUE(c.isAwaited());
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
  EXPECT_FALSE(c.isAwaited());
}

TEST(Confirmation, ASuddenChangeIsToldAtOnceAndFusedAtTheThird) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Agreeing);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Agreeing);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
}

TEST(Confirmation, ASecondChangeWhileOneIsAwaitedBeginsAnewAsAfterALoss) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Agreeing);
  EXPECT_EQ(c.next(showing(0.8), kShare, true, false), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Agreeing);
  EXPECT_EQ(c.next(showing(0.8), kShare, false, false), Standing::Confirmed);
}

TEST(Confirmation, WhileLittleIsKnownOfTheViewNothingIsFusedAndItIsToldLate) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.4), kShare, true, true), Standing::Supposed);
  for (int i = 2; i < 15; ++i) {
    EXPECT_EQ(c.next(showing(0.4), kShare, false, false), i < 10 ? Standing::Supposed : Standing::Agreeing);
    EXPECT_FALSE(c.knows());
  }
  EXPECT_EQ(c.next(showing(0.5), kShare, false, false), Standing::Confirmed);
  // What an earlier place knew speaks for no other.
  EXPECT_EQ(c.next(showing(0.4), kShare, true, true), Standing::Supposed);
  EXPECT_FALSE(c.knows());
}

TEST(Confirmation, OnceOneKnewEnoughTheNextMayKnowLess) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.5), kShare, true, true), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.3), kShare, false, false), Standing::Agreeing);
  EXPECT_EQ(c.next(showing(0.3), kShare, false, false), Standing::Confirmed);
}

TEST(UsualFit, AFoundPlaceMustFitAboutAsWellAsFramesDo) {
  PoseFit fit;
  fit.usable = 0.8;
  UsualFit usual;
  const double unknown = usual.leastClose();
  fit.close = 0.99 * fit.usable;
  for (int i = 0; i < 50; ++i) usual.add(fit);
  EXPECT_NEAR(usual.leastClose(), 0.93, 1e-9);
  fit.close = 0.94 * fit.usable;  // a noisier camera
  for (int i = 0; i < 100; ++i) usual.add(fit);
  EXPECT_NEAR(usual.leastClose(), 0.88, 1e-3);
  fit.close = 0.5 * fit.usable;
  for (int i = 0; i < 100; ++i) usual.add(fit);
  EXPECT_EQ(usual.leastClose(), unknown) << "bad tracking is no standard";
  fit.usable = fit.close = 0;
  usual.add(fit);
  EXPECT_EQ(usual.leastClose(), unknown);
}

TEST(Confirmation, WhatContradictsALittleIsToldAtTheThirdFrame) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.8, false), kShare, true, true), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.4, true), kShare, false, false), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Agreeing) << "the second was firm";
  EXPECT_EQ(c.next(showing(0.8, true), kShare, false, false), Standing::Confirmed);
}

TEST(Confirmation, WithoutAFirmFrameThreeAreEnough) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.8, false), kShare, true, true), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Supposed);
  EXPECT_EQ(c.next(showing(0.8, false), kShare, false, false), Standing::Confirmed);
}

TEST(Confirmation, AFrameThatFitsNowhereEndsIt) {
  Confirmation c;
  EXPECT_EQ(c.next(showing(0.8), kShare, true, true), Standing::Supposed);
  EXPECT_EQ(c.next({}, kShare, false, false), Standing::Refused);
  EXPECT_FALSE(c.isAwaited());
  c.next(showing(0.8), kShare, true, true);
  c.end();
  EXPECT_FALSE(c.isAwaited());
}

}  // namespace
}  // namespace rosefusion::testing
