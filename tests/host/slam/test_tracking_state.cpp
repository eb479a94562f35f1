// What becomes of a frame, by tables of what its image says.
#include "host/slam/tracking_state.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_tracking_state {

constexpr double kStep = 0.1;  // seconds between frames

Thresholds limits(bool relocalises = true) {
  Settings settings;
  settings.tracking.intruding_share = 0.05;
  settings.tracking.relocalised_share = 0.5;
  settings.refine.least_constraint = 0.001;
  return thresholdsOf(settings, relocalises);
}

Pose at(double x) {
  return Pose(Eigen::Translation3d(x, 0, 0));
}

PoseFit fitAt(double x, double observed = 0.9, double observability = 0.1) {
  PoseFit fit;
  fit.world_from_camera = at(x);
  fit.observed_ratio = observed;
  fit.inlier_ratio = 0.95 * observed;
  fit.observability = observability;
  fit.covariance.diagonal().setConstant(1e-4);  // 1 cm
  return fit;
}

/// A frame that fits well at `x`, as its method finds it.
FrameEvidence seen(double timestamp, double x, double observed = 0.9, double cost = 0.1) {
  FrameEvidence e;
  e.timestamp = timestamp;
  e.score = {0.1, 0.9, 0.8};
  e.found.emplace();
  e.found->fit = fitAt(x, observed);
  e.found->world_from_camera = at(x);
  e.found->cost = cost;
  return e;
}

FrameEvidence dark(double timestamp) {
  FrameEvidence e;
  e.timestamp = timestamp;
  e.score = {0, 1, 0.001};
  return e;
}

/// Three frames at 0, 0.1 and 0.2 m.
Tracking tracking() {
  TrackingState state;
  state = decide(state, {0, {0, 1, 0.8}, {}, {}, 0}, limits()).next;
  for (int i = 1; i < 3; ++i) state = decide(state, seen(i * kStep, 0.1 * i), limits()).next;
  return std::get<Tracking>(state);
}
constexpr double kNow = 3 * kStep;

Lost lost() {
  return std::get<Lost>(decide(tracking(), dark(kNow), limits()).next);
}

template <typename State>
bool is(const Decision& decision) {
  return std::holds_alternative<State>(decision.next);
}

TEST(Decide, TheFirstFrameWithDepthIsTheWorld) {
  const Decision nothing = decide(Initialising{}, dark(0), limits());
  EXPECT_TRUE(is<Initialising>(nothing));
  EXPECT_EQ(nothing.status, TrackingStatus::Lost);
  EXPECT_EQ(nothing.reason, Reason::LittleDepth);
  const Decision first = decide(nothing.next, {kStep, {0, 1, 0.8}, {}, {}, 0}, limits());
  EXPECT_TRUE(is<Tracking>(first));
  EXPECT_EQ(first.status, TrackingStatus::Tracked);
  EXPECT_TRUE(first.integrate);
  EXPECT_TRUE(first.pose->isApprox(Pose::Identity()));
}

TEST(Decide, AFollowedFrameByItsScore) {
  const struct {
    PoseScore score;  // residual, overlap, valid share
    TrackingStatus status;
    Reason reason;
  } cases[] = {{{0.1, 0.9, 0.8}, TrackingStatus::Tracked, Reason::None},
               {{0.1, 0.9, 0.01}, TrackingStatus::Lost, Reason::LittleDepth},
               {{0.1, 0, 0.8}, TrackingStatus::Lost, Reason::NoOverlap},
               {{0.7, 0.9, 0.8}, TrackingStatus::Lost, Reason::PoorFit},
               {{0.1, 0.2, 0.8}, TrackingStatus::Uncertain, Reason::LittleOverlap},
               {{0.4, 0.9, 0.8}, TrackingStatus::Uncertain, Reason::PoorFit}};
  for (const auto& c : cases) {
    FrameEvidence e = seen(kNow, 0.3);
    e.score = c.score;
    const Decision decision = decide(tracking(), e, limits());
    const bool is_lost = c.status == TrackingStatus::Lost;
    EXPECT_EQ(decision.status, c.status) << toString({c.reason});
    EXPECT_EQ(decision.reason, c.reason) << decision.reason;
    EXPECT_EQ(decision.pose.has_value(), !is_lost);
    EXPECT_EQ(decision.integrate, !is_lost);
    EXPECT_EQ(is<Lost>(decision), is_lost);
    EXPECT_NEAR(acceptedPose(decision.next).translation().x(), is_lost ? 0.2 : 0.3, 1e-12);
  }
}

TEST(Decide, AWeakDirectionMakesAPoseUncertain) {
  const struct {
    double observability, colour_cost, deviation;
    Reason reason;
  } cases[] = {{0.0009, 0, 0.006, Reason::Unconstrained},
               {0.0039, 0, 0.006, Reason::WeaklyConstrained},
               {0.0041, 0, 0.006, Reason::None},
               {0.0041, 0.1, 0.006, Reason::WeaklyConstrained},
               {0.0051, 0.1, 0.006, Reason::None},
               {0.0009, 0, 0.004, Reason::None}};  // weakly beside the others, but well enough
  for (const auto& c : cases) {
    FrameEvidence e = seen(kNow, 0.3);
    e.found->fit->observability = c.observability;
    e.found->fit->colour_cost = c.colour_cost;
    e.found->fit->covariance.diagonal().setConstant(c.deviation * c.deviation);
    const Decision decision = decide(tracking(), e, limits());
    EXPECT_EQ(decision.reason, c.reason) << c.observability << " " << decision.reason;
    EXPECT_TRUE(decision.integrate);
  }
}

TEST(Decide, AnOccluderIsNotIntegratedUntilItIsGone) {
  FrameEvidence hand = seen(kNow, 0.3, 0.7);
  hand.violation = 0.06;
  const Decision covered = decide(tracking(), hand, limits());
  EXPECT_EQ(covered.status, TrackingStatus::Uncertain);
  EXPECT_EQ(covered.reason, Reason::Occluded);
  EXPECT_TRUE(covered.pose);
  EXPECT_FALSE(covered.integrate);
  const struct {
    double violation, observed;
    bool gone;
  } cases[] = {{0.02, 0.6, true}, {0.03, 0.6, false}, {0.02, 0.45, false}};
  for (const auto& c : cases) {
    FrameEvidence next = seen(kNow + kStep, 0.4, c.observed);
    next.violation = c.violation;
    EXPECT_EQ(decide(covered.next, next, limits()).integrate, c.gone) << c.violation << " " << c.observed;
  }
  hand.found->fit->inlier_ratio = 0.1;
  const Decision hidden = decide(tracking(), hand, limits());
  EXPECT_EQ(hidden.reason, Reason::OccludedAndNotHeld);
  EXPECT_TRUE(is<Lost>(hidden));
}

TEST(Decide, WithoutRelocalisationGoesOnFromTheLast) {
  const Decision decision = decide(tracking(), dark(kNow), limits(false));
  EXPECT_EQ(decision.status, TrackingStatus::Lost);
  ASSERT_TRUE(is<Tracking>(decision));
  EXPECT_NEAR(historyOf(decision.next).last.translation().x(), 0.2, 1e-12);
}

TEST(Decide, AJumpIsVerifiedFirst) {
  TrackingState before = tracking();
  TrackingState told = before, turned = before;
  addOdometry(before, {});
  const struct {
    double cost, observed, timestamp;
    bool jump;
  } cases[] = {{0.1, 0.9, kNow, false},  {0.39, 0.9, kNow, false}, {0.41, 0.9, kNow, true},
               {0.1, 0.61, kNow, false}, {0.1, 0.59, kNow, true},  {0.1, 0.9, kNow + 5 * kStep, true}};
  for (const auto& c : cases) {
    const FrameEvidence e = seen(c.timestamp, 0.3, c.observed, c.cost);
    EXPECT_EQ(mustVerify(before, *e.found, c.timestamp, limits()), c.jump)
        << c.cost << " " << c.observed << " " << c.timestamp;
  }
  FrameEvidence late = seen(kNow + 5 * kStep, 0.3);
  addOdometry(told, CameraMotion{at(0.1), true});
  addOdometry(turned, CameraMotion{at(0.1), false});
  EXPECT_TRUE(mustVerify(before, *late.found, late.timestamp, limits()));
  EXPECT_TRUE(mustVerify(turned, *late.found, late.timestamp, limits()));
  EXPECT_EQ(mustVerify(told, *late.found, late.timestamp, limits()), false) << "a sensor has told of it";
  late.found->cost.reset();
  EXPECT_FALSE(mustVerify(before, *late.found, late.timestamp, limits())) << "a method that does not ask";
}

/// Decisions about one frame after the other, each verified.
class Verification : public ::testing::Test {
 protected:
  void begin(TrackingState state) { state_ = std::move(state); }
  Decision next(double observed, bool confident = true, bool jump = false) {
    now_ += kStep;
    // A jump by the cost; what is observed shrinks within what is usual.
    FrameEvidence e = seen(now_, x_ += step_, 0.9, jump ? 0.9 : 0.1);
    e.verified = VerifiedPose{fitAt(x_, observed), confident};
    const Decision decision = decide(state_, e, limits());
    state_ = decision.next;
    return decision;
  }
  Reason reasonOf(double observed, bool confident = true, bool jump = false) {
    return next(observed, confident, jump).reason.reason;
  }
  TrackingState state_ = lost();
  double now_ = kNow, x_ = 1, step_ = 0.1;
};

TEST_F(Verification, AfterALossReportsAt2AndIntegratesAt3) {
  const Decision first = next(0.8), second = next(0.8), third = next(0.8);
  EXPECT_EQ(first.status, TrackingStatus::Lost);
  EXPECT_EQ(first.reason, Reason::Tentative);
  EXPECT_FALSE(first.pose);
  EXPECT_NEAR(acceptedPose(first.next).translation().x(), 0.2, 1e-12);
  EXPECT_NEAR(historyOf(first.next).last.translation().x(), 1.1, 1e-12) << "the next is followed from there";
  EXPECT_TRUE(historyOf(first.next).tentative);
  EXPECT_EQ(second.status, TrackingStatus::Relocalised);
  EXPECT_EQ(second.reason, Reason::ConsistentOnce);
  EXPECT_TRUE(second.pose);
  EXPECT_FALSE(second.integrate);
  EXPECT_EQ(third.status, TrackingStatus::Tracked);
  EXPECT_TRUE(third.integrate);
  EXPECT_TRUE(is<Tracking>(third));
  EXPECT_FALSE(historyOf(third.next).tentative);
}

TEST_F(Verification, AfterAJumpReportsAt1AndIntegratesAt3) {
  begin(tracking());
  EXPECT_EQ(reasonOf(0.8, true, true), Reason::Jump);
  EXPECT_EQ(reasonOf(0.8), Reason::ConsistentOnce);
  EXPECT_TRUE(next(0.8).integrate);
}

TEST_F(Verification, ASecondJumpBeginsAnewAsAfterALoss) {
  begin(tracking());
  EXPECT_EQ(reasonOf(0.8, true, true), Reason::Jump);
  EXPECT_EQ(reasonOf(0.8, true, true), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.8), Reason::ConsistentOnce);
  EXPECT_EQ(reasonOf(0.8), Reason::None);
}

TEST_F(Verification, WithLittleOverlapReportsLateAndKeepsOut) {
  step_ = 0.02;
  for (int i = 1; i < 15; ++i)
    EXPECT_EQ(reasonOf(0.4), i < 10 ? Reason::Tentative : Reason::ConsistentUnknown);
  EXPECT_EQ(reasonOf(0.5), Reason::None);
  // What an earlier place knew speaks for no other.
  begin(lost());
  EXPECT_EQ(reasonOf(0.4), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.4), Reason::Tentative);
}

// What moves with the camera does not go on fitting; neither does a place that looks alike.
TEST_F(Verification, WithLittleOverlapMovingOnIntegrates) {
  for (int i = 1; i < 10; ++i) EXPECT_EQ(reasonOf(0.4), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.4), Reason::ConsistentUnknown);
  EXPECT_EQ(reasonOf(0.4, false), Reason::ConsistentUnknown) << "it contradicts a little";
  const Decision confident = next(0.4);
  EXPECT_EQ(confident.status, TrackingStatus::Tracked);
  EXPECT_TRUE(confident.integrate);
}

TEST_F(Verification, TentativePosesComeWithTheReport) {
  EXPECT_TRUE(next(0.4).recovered.empty());
  EXPECT_TRUE(next(0.4, true, true).recovered.empty()) << "another place";
  for (int i = 2; i < 10; ++i) EXPECT_TRUE(next(0.4).recovered.empty());
  const Trajectory recovered = next(0.4).recovered;
  ASSERT_EQ(recovered.size(), 9u);
  for (std::size_t i = 0; i < recovered.size(); ++i) {
    EXPECT_NEAR(recovered[i].timestamp, kNow + static_cast<double>(2 + i) * kStep, 1e-9);
    EXPECT_NEAR(recovered[i].world_from_camera.translation().x(), 1.2 + 0.1 * static_cast<double>(i), 1e-9);
  }
  EXPECT_TRUE(next(0.4).recovered.empty()) << "they are told once";
}

TEST_F(Verification, OnceOneFrameKnewEnoughTheNextMayKnowLess) {
  EXPECT_EQ(reasonOf(0.5), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.3), Reason::ConsistentOnce);
  EXPECT_EQ(reasonOf(0.3), Reason::None);
}

TEST_F(Verification, WithLittleConfidenceReportsAt3) {
  EXPECT_EQ(reasonOf(0.8, false), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.4, true), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.8, false), Reason::ConsistentOnce) << "the second had high confidence";
  EXPECT_EQ(reasonOf(0.8, true), Reason::None);
}

TEST_F(Verification, WithoutAConfidentFrameThreeAreEnough) {
  EXPECT_EQ(reasonOf(0.8, false), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.8, false), Reason::Tentative);
  EXPECT_EQ(reasonOf(0.8, false), Reason::None);
}

TEST_F(Verification, AFrameWithoutFitRestoresTheState) {
  next(0.8);
  next(0.8);
  FrameEvidence e = seen(now_ + kStep, 5);
  const Decision decision = decide(state_, e, limits());
  EXPECT_EQ(decision.reason, Reason::NotVerified);
  ASSERT_TRUE(is<Lost>(decision));
  EXPECT_NEAR(historyOf(decision.next).last.translation().x(), 0.2, 1e-12);
  EXPECT_TRUE(is<Lost>(decide(state_, dark(now_ + kStep), limits())));
}

TEST_F(Verification, AConfirmedPoseMayHaveAnOpenDirection) {
  next(0.8);
  next(0.8);
  FrameEvidence e = seen(now_ + kStep, x_ + 0.1);
  e.verified = VerifiedPose{fitAt(x_ + 0.1, 0.8, 0.002), true};
  const Decision decision = decide(state_, e, limits());
  EXPECT_EQ(decision.status, TrackingStatus::Uncertain);
  EXPECT_TRUE(decision.integrate);
}

// A hand that came before the jump is still there after it.
TEST_F(Verification, WhatWasBeforeTheCameraIsRemembered) {
  Tracking covered = tracking();
  covered.occluded = true;
  begin(covered);
  next(0.8, true, true);
  next(0.8);
  const Decision third = next(0.8);
  EXPECT_EQ(third.status, TrackingStatus::Tracked);
  EXPECT_FALSE(third.integrate);
}

TEST(TrackingState, OdometryAndCorrectionsReachAllPoses) {
  FrameEvidence e = seen(kNow, 1.0, 0.9, 0.9);
  e.verified = VerifiedPose{fitAt(1.0), true};
  TrackingState state = decide(tracking(), e, limits()).next;
  ASSERT_TRUE(std::holds_alternative<Verifying>(state));
  addOdometry(state, CameraMotion{at(0.5), true});
  EXPECT_NEAR(std::get<Verifying>(state).candidate.withOdometry(at(0)).translation().x(), 1.5, 1e-12);
  EXPECT_NEAR(std::get<Verifying>(state).before.withOdometry(at(0)).translation().x(), 0.7, 1e-12);
  move(state, at(1.25));
  EXPECT_NEAR(historyOf(state).last.translation().x(), 1.25, 1e-12);
  EXPECT_NEAR(acceptedPose(state).translation().x(), 0.45, 1e-12);
}

TEST(TrackingState, AKnownPoseEndsEveryDoubt) {
  for (const TrackingState& state :
       {TrackingState(Initialising{}), TrackingState(tracking()), TrackingState(lost())}) {
    const TrackingState known = accepted(state, at(3), kNow + kStep);
    ASSERT_TRUE(std::holds_alternative<Tracking>(known));
    EXPECT_NEAR(acceptedPose(known).translation().x(), 3, 1e-12);
  }
}

TEST(TrackingState, AskingChangesNothing) {
  const TrackingState state = tracking();
  const FrameEvidence e = seen(kNow, 0.3);
  const Decision first = decide(state, e, limits()), second = decide(state, e, limits());
  EXPECT_EQ(historyOf(first.next).costs, historyOf(second.next).costs);
  EXPECT_EQ(historyOf(state).costs.size() + 1, historyOf(first.next).costs.size());
}

}  // namespace test_tracking_state
}  // namespace rosefusion::testing
