#include "host/slam/tracking_state.h"

#include <utility>

namespace rosefusion {
namespace {

bool isOccluded(const TrackingState& state) {
  if (const auto* tracking = std::get_if<Tracking>(&state)) return tracking->occluded;
  if (const auto* verifying = std::get_if<Verifying>(&state)) return verifying->occluded;
  return false;
}

/// The histories of a state; none while Initialising.
std::vector<TrackHistory*> historiesOf(TrackingState& state) {
  if (auto* tracking = std::get_if<Tracking>(&state)) return {&tracking->history};
  if (auto* lost = std::get_if<Lost>(&state)) return {&lost->before};
  if (auto* verifying = std::get_if<Verifying>(&state)) return {&verifying->candidate, &verifying->before};
  return {};
}

TrackHistory advanced(const TrackingState& state, const Pose& pose, double timestamp, bool tentative,
                      const std::optional<TrackResult>& found) {
  TrackHistory history = historyOf(state);
  if (std::holds_alternative<Lost>(state)) history.interrupt();
  history.advance(pose, timestamp, found);
  history.tentative = tentative;
  return history;
}

bool isJump(const TrackHistory& before, const TrackResult& found, double timestamp, const Thresholds& t) {
  if (!found.cost) return false;
  const std::optional<double> usual = before.medianCost();
  const bool has_odometry = before.odometry && before.odometry->has_translation;
  return (usual && *found.cost > *usual + t.jump_excess) ||
         (before.observed_ratio && found.fit->observed_ratio < *before.observed_ratio - t.suddenly_unknown) ||
         (!has_odometry && before.motion.isInterrupted(timestamp));
}

/// A pose whose depth leaves a direction open is held there by the motion model, and may drift.
Judgement judgeConstraint(const std::optional<PoseFit>& fit, Judgement judgement, const Thresholds& t) {
  if (!fit || judgement.status != TrackingStatus::Tracked) return judgement;
  const double factor = fit->colour_cost > 0 ? t.weak_constraint_with_colour : t.weak_constraint;
  if (fit->observability >= factor * t.least_constraint || fit->shiftDeviation() <= t.uncertain_deviation)
    return judgement;
  return {TrackingStatus::Uncertain,
          {fit->observability < t.least_constraint ? Reason::Unconstrained : Reason::WeaklyConstrained}};
}

/// What came before the camera is gone when the image shows the model again; that it is no longer where the
/// last integrated frame looked is not enough.
bool isOccludedNow(bool occluded, const FrameEvidence& e, const Thresholds& t) {
  if (e.violation > t.intruding_share) return true;
  const std::optional<PoseFit>& fit = e.found->fit;
  return occluded && !(fit && e.violation <= t.gone * t.intruding_share &&
                       fit->holds(t.relocalised_share, t.least_constraint));
}

Decision noPose(const TrackingState& state, const StatusReason& reason, const Thresholds& t) {
  return {withoutPose(state, t), TrackingStatus::Lost, reason, {}, false, {}};
}

Decision accept(const TrackingState& state, const FrameEvidence& e, const Pose& pose,
                const Judgement& judgement, bool occluded) {
  return {Tracking{advanced(state, pose, e.timestamp, false, e.found), occluded},
          judgement.status,
          judgement.reason,
          pose,
          !occluded,
          {}};
}

Decision decideFollowed(const TrackingState& state, const FrameEvidence& e, const Thresholds& t) {
  Judgement judgement = judgeConstraint(e.found->fit, judge(e.score, t), t);
  if (judgement.status == TrackingStatus::Lost) return noPose(state, judgement.reason, t);
  const bool occluded = isOccludedNow(isOccluded(state), e, t);
  if (occluded) {
    const std::optional<PoseFit>& fit = e.found->fit;
    if (!fit || !fit->holds(t.share_of_next * t.relocalised_share, t.least_constraint))
      return noPose(state, {Reason::OccludedAndNotHeld, e.violation}, t);
    judgement = {TrackingStatus::Uncertain, {Reason::Occluded, e.violation}};
  }
  return accept(state, e, e.found->world_from_camera, judgement, occluded);
}

Decision decideVerified(const TrackingState& state, const FrameEvidence& e, const Thresholds& t) {
  if (!e.verified) return noPose(state, {Reason::NotVerified}, t);
  const PoseFit& fit = e.verified->fit;
  const auto* pending = std::get_if<Verifying>(&state);
  const bool unsure = isUnsure(state, *e.found, e.timestamp, t);
  Verifying next = pending ? *pending : Verifying{};
  next.before = pending ? pending->before : historyOf(state);
  next.candidate = advanced(state, fit.world_from_camera, e.timestamp, true, e.found);
  if (unsure) {
    next.after_loss = pending || std::holds_alternative<Lost>(state);
    next.consistent = 0;
    next.high_confidence = next.overlap = next.confident_overlap = false;
    next.unreported.clear();
  }
  const bool overlap = fit.observed_ratio >= t.relocalised_share, confident = e.verified->high_confidence;
  if (++next.consistent == 1) next.first = fit.world_from_camera;
  // What moves with the camera, or looks alike here and there, does not go on fitting where the camera moves
  // on.
  const bool moved_on = next.consistent > t.reported_unknown_at && confident &&
                        !areNear(next.first, fit.world_from_camera, kElsewhere, kElsewhere);
  next.overlap |= overlap;
  next.high_confidence |= confident;
  next.confident_overlap |= overlap && confident;
  const int reported_at = next.confident_overlap ? t.reported_at
                          : next.overlap         ? t.integrated_at
                                                 : t.reported_unknown_at;
  if (next.after_loss && next.consistent < reported_at) {
    next.occluded = false;
    next.unreported.push_back({e.timestamp, fit.world_from_camera});
    return {next, TrackingStatus::Lost, {Reason::Tentative}, {}, false, {}};
  }
  next.occluded = isOccluded(state);
  const Trajectory recovered = std::exchange(next.unreported, {});
  if (!(next.overlap || moved_on) || next.consistent < t.integrated_at ||
      (next.high_confidence && !confident)) {
    const Reason reason = unsure         ? Reason::Jump
                          : next.overlap ? Reason::ConsistentOnce
                                         : Reason::ConsistentUnknown;
    return {next, TrackingStatus::Relocalised, {reason}, fit.world_from_camera, false, recovered};
  }
  Decision decision = accept(state, e, fit.world_from_camera, judgeConstraint(fit, {}, t), next.occluded);
  decision.recovered = recovered;
  return decision;
}

}  // namespace

const char* toString(TrackingStatus status) {
  return status == TrackingStatus::Tracked       ? "tracked"
         : status == TrackingStatus::Uncertain   ? "uncertain"
         : status == TrackingStatus::Relocalised ? "relocalised"
                                                 : "lost";
}

Thresholds thresholdsOf(const Settings& settings, bool relocalises) {
  const TrackingSettings& s = settings.tracking;
  return {s.min_valid_share,
          s.uncertain_overlap,
          s.uncertain_residual,
          s.lost_residual,
          s.relocalised_share,
          s.intruding_share,
          settings.refine.least_constraint,
          s.uncertain_deviation,
          relocalises};
}

Judgement judge(const PoseScore& score, const Thresholds& t) {
  using Status = TrackingStatus;
  if (score.valid_share < t.min_valid_share) return {Status::Lost, {Reason::LittleDepth, score.valid_share}};
  if (score.overlap == 0) return {Status::Lost, {Reason::NoOverlap}};
  if (score.residual > t.lost_residual) return {Status::Lost, {Reason::PoorFit, score.residual}};
  if (score.overlap < t.uncertain_overlap) return {Status::Uncertain, {Reason::LittleOverlap, score.overlap}};
  if (score.residual > t.uncertain_residual) return {Status::Uncertain, {Reason::PoorFit, score.residual}};
  return {};
}

bool isUnsure(const TrackingState& state, const TrackResult& found, double timestamp, const Thresholds& t) {
  return std::holds_alternative<Lost>(state) || isJump(historyOf(state), found, timestamp, t);
}

bool mustVerify(const TrackingState& state, const TrackResult& found, double timestamp, const Thresholds& t) {
  return std::holds_alternative<Verifying>(state) || isUnsure(state, found, timestamp, t);
}

Decision decide(const TrackingState& state, const FrameEvidence& e, const Thresholds& t) {
  if (e.found)
    return mustVerify(state, *e.found, e.timestamp, t) ? decideVerified(state, e, t)
                                                       : decideFollowed(state, e, t);
  const Judgement judgement = judge(e.score, t);
  return judgement.status == TrackingStatus::Lost
             ? noPose(state, judgement.reason, t)
             : accept(state, e, acceptedPose(state), judgement, false);  // the first frame
}

const TrackHistory& historyOf(const TrackingState& state) {
  static const TrackHistory none;
  if (const auto* tracking = std::get_if<Tracking>(&state)) return tracking->history;
  if (const auto* verifying = std::get_if<Verifying>(&state)) return verifying->candidate;
  if (const auto* lost = std::get_if<Lost>(&state)) return lost->before;
  return none;
}

Pose acceptedPose(const TrackingState& state) {
  const auto* verifying = std::get_if<Verifying>(&state);
  return verifying ? verifying->before.last : historyOf(state).last;
}

void addOdometry(TrackingState& state, const std::optional<CameraMotion>& motion) {
  for (TrackHistory* history : historiesOf(state)) history->addOdometry(motion);
}

TrackingState accepted(const TrackingState& state, const Pose& pose, double timestamp) {
  return Tracking{advanced(state, pose, timestamp, false, {}), isOccluded(state)};
}

TrackingState withoutPose(const TrackingState& state, const Thresholds& t) {
  if (const auto* verifying = std::get_if<Verifying>(&state)) return Lost{verifying->before};
  const auto* tracking = std::get_if<Tracking>(&state);
  if (!tracking) return state;
  return t.relocalises ? TrackingState(Lost{tracking->history}) : Tracking{tracking->history, false};
}

void move(TrackingState& state, const Pose& world_from_last) {
  const Pose new_from_old_world = world_from_last * historyOf(state).last.inverse();
  for (TrackHistory* history : historiesOf(state)) history->rebase(new_from_old_world);
}

}  // namespace rosefusion
