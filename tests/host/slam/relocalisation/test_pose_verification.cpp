// How many frames must agree before one is told, and before one is fused.
#include "host/slam/relocalisation/pose_verification.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_belief {

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

PoseFit closeBy(double share) {
  PoseFit fit;
  fit.usable = 0.8;
  fit.close = share * fit.usable;
  return fit;
}

constexpr double kIntruding = 0.05;

TEST(UsualFit, ALostCameraMustFitAboutAsWellAsItsFramesDo) {
  UsualFit usual;
  const AskedOfPlace otherwise = usual.asked(false, kIntruding);
  EXPECT_EQ(usual.asked(true, kIntruding).close, otherwise.close) << "nothing is usual yet";
  EXPECT_EQ(usual.asked(true, kIntruding).through, otherwise.through);
  for (int i = 0; i < 20; ++i) usual.add(closeBy(0.99));
  EXPECT_NEAR(usual.asked(true, kIntruding).close, 0.97, 1e-6);
  EXPECT_EQ(usual.asked(false, kIntruding).close, otherwise.close) << "it may see what is new";
  usual.add(PoseFit{});
  EXPECT_NEAR(usual.asked(true, kIntruding).close, 0.97, 1e-6) << "a frame that knows nothing says nothing";
  for (int i = 0; i < 400; ++i) usual.add(closeBy(0.5));
  EXPECT_EQ(usual.asked(true, kIntruding).close, otherwise.close) << "bad tracking is no standard";
  EXPECT_EQ(usual.asked(true, kIntruding).through, kIntruding);
}

TEST(UsualFit, WhereFramesDifferAFoundPlaceMayDifferAsMuch) {
  UsualFit usual;
  for (int i = 0; i < 400; ++i) usual.add(closeBy(i % 2 ? 0.98 : 0.94));
  EXPECT_NEAR(usual.asked(true, kIntruding).close, 0.96 - 3 * 0.02, 0.002);
  EXPECT_NEAR(usual.asked(true, kIntruding).through, 0.04, 0.001);
  EXPECT_EQ(usual.asked(false, kIntruding).through, kIntrudingWhenFound * kIntruding);
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

}  // namespace test_belief
}  // namespace rosefusion::testing
