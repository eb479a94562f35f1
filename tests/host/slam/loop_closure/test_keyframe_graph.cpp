// Keyframes: which frames become one, what hangs on them, what is recognised, and how closing moves it all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/slam/loop_closure/keyframe_graph.h"

namespace rosefusion::testing {
namespace test_keyframe_graph {

using ::testing::ElementsAre;
using ::testing::Optional;

Pose at(double x, double y = 0, double turn = 0) {
  return Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()) * Pose::Identity();
}

bool any(std::size_t) {
  return true;
}
double unknown(std::size_t) {
  return 0;
}

/// There and back along x, a step of 10 cm at a time; what is measured coming back drifts to y.
KeyframeGraph thereAndBack(double drift) {
  KeyframeGraph map{LoopSettings{}};
  for (int i = 0; i <= 80; ++i) map.add(at(0.1 * (i <= 40 ? i : 80 - i), drift * i / 80), true, true);
  return map;
}

TEST(KeyframeGraph, KeyframesNeedMotionOrTurn) {
  KeyframeGraph map{LoopSettings{}};
  EXPECT_TRUE(map.add(at(0), true, true));
  EXPECT_FALSE(map.add(at(0.1), true, true));
  EXPECT_TRUE(map.add(at(0.16), true, true));
  EXPECT_FALSE(map.add(at(0.16, 0, 0.1), true, true));
  EXPECT_TRUE(map.add(at(0.16, 0, 0.2), true, true));
  EXPECT_FALSE(map.add(at(5), false, true)) << "a frame that was not fused cannot be one";
  EXPECT_EQ(map.size(), 3u);
  EXPECT_EQ(map.framePoses().size(), 6u);
  EXPECT_NEAR(map.travelled(), 0.16 + 0.2 + 4.84 + 0.2, 1e-12) << "metres and radians";
}

TEST(KeyframeGraph, OnlyOldKeyframesInReachAreRecognised) {
  const KeyframeGraph map = thereAndBack(0.05);
  EXPECT_THAT(map.candidate(any, unknown), Optional(0u));
  EXPECT_THAT(map.candidate([](std::size_t i) { return i != 0; }, unknown), Optional(1u));
  EXPECT_FALSE(thereAndBack(1.2).candidate(any, unknown)) << "beyond loops.reach";
  KeyframeGraph turned = thereAndBack(0.05);
  turned.add(at(0, 0, 1), true, true);
  EXPECT_FALSE(turned.candidate(any, unknown)) << "another view";
  KeyframeGraph young{LoopSettings{}};
  for (int i = 0; i < 8; ++i) young.add(at(0.2 * i), true, true);
  EXPECT_FALSE(young.candidate(any, unknown)) << "passed just before";
}

TEST(KeyframeGraph, RecognisesThePlaceThatSharesMost) {
  const KeyframeGraph map = thereAndBack(0.05);
  const auto seen = [](std::size_t i) { return i == 12 ? 0.6 : i == 15 ? 0.5 : i + 1 == 41 ? 0.9 : 0.1; };
  EXPECT_THAT(map.candidate(any, seen), Optional(12u)) << "the newest, which shares most, is too young";
  EXPECT_THAT(map.candidate([](std::size_t i) { return i != 12; }, seen), Optional(15u));
  EXPECT_THAT(map.candidate(any, [](std::size_t i) { return i == 12 ? 0.3 : 0; }), Optional(0u))
      << "too little";
  EXPECT_THAT(thereAndBack(1.2).candidate(any, seen), Optional(12u)) << "drift beyond loops.reach";
}

TEST(KeyframeGraph, NeighboursNeverLieAcrossALoss) {
  KeyframeGraph map = thereAndBack(0);
  EXPECT_THAT(map.neighbours(7, any), ElementsAre(3, 4, 5, 6, 7, 8, 9, 10, 11)) << "within loops.reach";
  EXPECT_THAT(map.neighbours(0, any), ElementsAre(0, 1, 2, 3, 4));
  const std::size_t last = map.size() - 1;
  map.onTrackingLost();
  map.add(at(2.5), true, true);
  EXPECT_THAT(map.neighbours(last + 1, any), ElementsAre(last + 1));
}

TEST(KeyframeGraph, ClosingTakesAllFramesAlong) {
  KeyframeGraph map = thereAndBack(0.2);
  const std::vector<Pose> before = map.framePoses();
  map.addConstraint(map.constraintTo(0, at(0)));
  ASSERT_TRUE(map.close());
  const std::vector<Pose> after = map.framePoses();
  ASSERT_EQ(after.size(), 81u);
  EXPECT_EQ(after[0].matrix(), before[0].matrix());
  EXPECT_LT(after[80].translation().norm(), 0.02);
  for (std::size_t i = 1; i < after.size(); ++i) {
    EXPECT_LT(std::abs(after[i].translation().y()), 0.5 * 0.2) << i;
    EXPECT_LT((after[i].translation() - after[i - 1].translation()).norm(), 0.11) << "no jump at frame " << i;
  }
}

// A single frame before a flat wall must not take up a whole loop's drift.
TEST(KeyframeGraph, LooseFramesInflateTheirShareOfAMotion) {
  const auto shareOfFirstStep = [](double loose_from, double loose_to) {
    KeyframeGraph map{LoopSettings{}};
    for (int i = 0; i <= 600; ++i) {  // a step of 1 cm at a time, the first 20 cm partly not constrained
      const double x = 0.01 * (i <= 300 ? i : 600 - i);
      map.add(at(x), true, !(i <= 20 && x > loose_from && x <= loose_to));
    }
    map.addConstraint(map.constraintTo(0, at(0, 0.3)));
    EXPECT_TRUE(map.close());
    return map.pose(1).translation().y() / 0.3;
  };
  const double constrained = shareOfFirstStep(1, 1), little = shareOfFirstStep(0, 0.015),
               all = shareOfFirstStep(0, 1);
  EXPECT_LT(little, 5 * constrained);
  EXPECT_GT(all, 10 * constrained);
}

TEST(KeyframeGraph, AWellConstrainedStepIsNoDrift) {
  for (const bool constrained : {true, false}) {
    KeyframeGraph map{LoopSettings{}};
    const auto add = [&](int i, double drift, bool held) {
      return map.add(at(0.1 * (80 - i), drift), true, held);
    };
    for (int i = 0; i <= 40; ++i) map.add(at(0.1 * i), true, true);
    for (int i = 41; i <= 60; ++i) add(i, 0.4, true);
    map.addConstraint(map.constraintTo(10, at(2)));
    ASSERT_TRUE(add(62, 0, constrained));
    map.addConstraint(map.constraintTo(9, at(1.8)));
    EXPECT_EQ(map.close(), !constrained);
  }
}

// The tracker slid back onto the old map: by what it says, nothing drifted.
TEST(KeyframeGraph, LocalOdometryShowsDriftHiddenByASlide) {
  constexpr double kDrift = 0.2;
  const auto slidingMap = [](std::vector<Pose>& anew) {
    KeyframeGraph map{LoopSettings{}};
    for (int i = 0; i <= 40; ++i) {
      const double out = i <= 20 ? i : 40 - i, drifted = kDrift * std::min(i, 32) / 32;
      map.add(at(0.2 * out, i <= 32 ? drifted : kDrift * (40 - i) / 8), true, true);
      if (i >= 32) anew.push_back(at(0.2 * out, drifted));
    }
    map.addConstraint(map.constraintTo(0, map.pose(40)));
    return map;
  };
  std::vector<Pose> anew, unused;
  KeyframeGraph as_tracked = slidingMap(unused), measured = slidingMap(anew);
  ASSERT_TRUE(as_tracked.close());
  EXPECT_NEAR(as_tracked.pose(32).translation().y(), kDrift, 1e-3);
  ASSERT_TRUE(measured.close(anew));
  EXPECT_LT(measured.pose(32).translation().y(), 0.3 * kDrift);
  EXPECT_NEAR(measured.pose(40).translation().y(), 0, 0.01);
  ASSERT_TRUE(measured.close()) << "they stay";
  EXPECT_LT(measured.pose(32).translation().y(), 0.3 * kDrift);
}

TEST(KeyframeGraph, TellsWhenTheNewestMeetsOldPlaces) {
  KeyframeGraph map{LoopSettings{}};
  for (int i = 0; i <= 40; ++i) map.add(at(0.2 * i), true, true);
  const auto onlyWith = [](std::size_t keyframe) {
    return [keyframe](std::size_t i) { return i == keyframe ? 0.1 : 0; };
  };
  EXPECT_TRUE(map.overlapsOld(0.05, onlyWith(3)));
  EXPECT_FALSE(map.overlapsOld(0.2, onlyWith(3)));
  EXPECT_FALSE(map.overlapsOld(0.05, onlyWith(39))) << "that was passed just now";
}

TEST(KeyframeGraph, FramesAfterAClosureFollowTheCorrection) {
  KeyframeGraph map = thereAndBack(0.2);
  map.addConstraint(map.constraintTo(0, at(0)));
  ASSERT_TRUE(map.close());
  const double travelled = map.travelled();
  const Pose next = map.framePoses().back() * at(0.05);
  map.add(next, true, true);
  EXPECT_NEAR(map.travelled() - travelled, 0.05, 1e-9) << "the correction is no way travelled";
  EXPECT_TRUE(map.framePoses().back().isApprox(next));
}

TEST(KeyframeGraph, ATieThatContradictsAnOlderOneIsForgotten) {
  KeyframeGraph map = thereAndBack(0.2);
  map.addConstraint(map.constraintTo(0, at(0)));
  ASSERT_TRUE(map.close());
  const std::vector<Pose> before = map.framePoses();
  map.addConstraint(map.constraintTo(1, at(0, 0.6)));
  EXPECT_FALSE(map.close());
  EXPECT_EQ(map.framePoses().back().matrix(), before.back().matrix());
  EXPECT_TRUE(map.close()) << "it is gone";
  EXPECT_TRUE(map.framePoses().back().isApprox(before.back(), 1e-6));
}

TEST(KeyframeGraph, AfterALossFramesJoinTheNearestKeyframe) {
  KeyframeGraph map{LoopSettings{}};
  for (int i = 0; i <= 40; ++i) map.add(at(0.2 * i), true, true);  // drifts away, and is lost at 8 m
  map.onTrackingLost();
  map.add(at(0.31, 0.05), false, true);
  map.add(at(0.33, 0.05), true, true);
  ASSERT_EQ(map.size(), 42u);
  map.addConstraint({0, 40, at(8, 0.5), 0.003, 0.001});
  ASSERT_TRUE(map.close());
  // The end of the way before the loss moves by half a metre; what was found near the start stays there.
  EXPECT_NEAR(map.pose(40).translation().y(), 0.5, 0.02);
  EXPECT_NEAR(map.pose(41).translation().y(), 0.05, 0.03);
  EXPECT_NEAR(map.framePoses()[41].translation().y(), 0.05, 0.03);
}

}  // namespace test_keyframe_graph
}  // namespace rosefusion::testing
