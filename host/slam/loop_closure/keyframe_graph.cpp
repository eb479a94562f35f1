#include "host/slam/loop_closure/keyframe_graph.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

// Tracking is off by about a hundredth of the motion, and turns by as much as shifts seem at 2.5 m.
constexpr double kShiftDeviation = 0.001, kShiftShare = 0.01, kTurnPerShift = 0.4;
constexpr double kInflation = 10;  // of motions in which the depth left a direction open
constexpr double kLoopDeviation = 0.003, kUnsureLoopDeviation = 0.01;
constexpr double kMostResidual = 0.05;  // metres that a loop constraint may be contradicted by
constexpr double kMostDeviations = 10;  // and a tracked motion, if that is more: a jump is no drift
constexpr double kViewTurn = 0.6;       // radians within which views overlap enough
constexpr double kEnoughOverlap = 0.4;
constexpr int kNeighbours = 8;  // to either side, within loops.reach

PoseEdge edgeOf(std::size_t first, std::size_t second, const Pose& motion, double deviation) {
  return {first, second, motion, deviation, kTurnPerShift * deviation};
}

}  // namespace

bool KeyframeGraph::add(const Pose& pose, bool fused, bool well_constrained) {
  const double way = frames_.empty() ? 0 : shiftBetween(pose, last_) + turnBetween(pose, last_);
  travelled_ += way;
  if (!well_constrained) weak_path_ += way;
  last_ = pose;
  if (keyframes_.empty() && !fused) return false;
  std::size_t reference = keyframes_.empty() ? 0 : broken_ ? nearest(pose) : keyframes_.size() - 1;
  Pose motion =
      keyframes_.empty() ? Pose::Identity() : keyframes_[reference].world_from_camera.inverse() * pose;
  const double shift = motion.translation().norm(), turn = rotationAngle(motion);
  const bool far =
      keyframes_.empty() || broken_ || shift >= settings_.keyframe_shift || turn >= settings_.keyframe_turn;
  if (fused && far) {
    if (!keyframes_.empty()) {
      const double all = std::max(travelled_ - keyframes_.back().travelled, 1e-9);
      const double inflation = 1 + (kInflation - 1) * weak_path_ / all;
      edges_.push_back(edgeOf(reference, keyframes_.size(), motion,
                              inflation * (kShiftDeviation + kShiftShare * (shift + turn))));
    }
    reference = keyframes_.size();
    motion = Pose::Identity();
    keyframes_.push_back({pose, travelled_});
    broken_ = false;
    weak_path_ = 0;
  }
  frames_.push_back({reference, motion});
  return fused && far;
}

std::size_t KeyframeGraph::nearest(const Pose& pose) const {
  const auto distance = [&](const Keyframe& k) {
    return shiftBetween(k.world_from_camera, pose) + turnBetween(k.world_from_camera, pose);
  };
  const auto least =
      std::min_element(keyframes_.begin(), keyframes_.end(),
                       [&](const Keyframe& a, const Keyframe& b) { return distance(a) < distance(b); });
  return static_cast<std::size_t>(least - keyframes_.begin());
}

std::optional<std::size_t> KeyframeGraph::candidate(const std::function<bool(std::size_t)>& usable,
                                                    const std::function<double(std::size_t)>& overlap) const {
  const Keyframe& newest = keyframes_.back();
  std::optional<std::size_t> closest, widest;
  double least = 0, most = kEnoughOverlap;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const Keyframe& old = keyframes_[i];
    if (newest.travelled - old.travelled < settings_.min_travel) break;
    if (!usable(i)) continue;
    if (const double shared = overlap(i); shared > most) {
      widest = i;
      most = shared;
    }
    const double shift = shiftBetween(old.world_from_camera, newest.world_from_camera);
    const double turn = turnBetween(old.world_from_camera, newest.world_from_camera);
    if (shift > settings_.reach || turn > kViewTurn) continue;
    const double distance = shift / settings_.reach + turn / kViewTurn;
    if (closest && distance >= least) continue;
    closest = i;
    least = distance;
  }
  return widest ? widest : closest;
}

std::vector<std::size_t> KeyframeGraph::neighbours(std::size_t keyframe,
                                                   const std::function<bool(std::size_t)>& usable) const {
  std::vector<std::size_t> out;
  const std::size_t first = keyframe - std::min<std::size_t>(keyframe, kNeighbours);
  const std::size_t end = std::min(keyframes_.size(), keyframe + kNeighbours + 1);
  for (std::size_t i = first; i < end; ++i) {
    const Pose &a = pose(keyframe), &b = pose(i);
    // Keyframes on either side of a loss are no neighbours.
    if (usable(i) && shiftBetween(a, b) < settings_.reach && turnBetween(a, b) < 2 * kViewTurn)
      out.push_back(i);
  }
  return out;
}

PoseEdge KeyframeGraph::constraintTo(std::size_t old, const Pose& world_from_newest, bool sure) const {
  return edgeOf(old, keyframes_.size() - 1, pose(old).inverse() * world_from_newest,
                sure ? kLoopDeviation : kUnsureLoopDeviation);
}

bool KeyframeGraph::overlapsOld(double least, const std::function<double(std::size_t)>& overlap) const {
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_.back().travelled - keyframes_[i].travelled < settings_.min_travel) break;
    if (overlap(i) >= least) return true;
  }
  return false;
}

bool KeyframeGraph::close(std::span<const Pose> way) {
  std::vector<Pose> poses;
  for (const Keyframe& k : keyframes_) poses.push_back(k.world_from_camera);
  std::vector<PoseEdge> all = edges_;
  for (std::size_t i = 1; i < way.size(); ++i)
    all[edges_.size() - way.size() + i].first_from_second = way[i - 1].inverse() * way[i];
  all.insert(all.end(), constraints_.begin(), constraints_.end());
  const PoseEdge* const constraints = all.data() + edges_.size();
  poses = optimisePoses(std::move(poses), all);
  const bool contradicted = std::any_of(all.begin(), all.end(), [&](const PoseEdge& edge) {
    const double residual = residualOf(edge, poses);
    return residual > kMostResidual &&
           (&edge >= constraints || residual > kMostDeviations * edge.shift_deviation);
  });
  if (contradicted) {
    constraints_.resize(closed_constraints_);
    return false;
  }
  for (std::size_t i = 0; i < keyframes_.size(); ++i) keyframes_[i].world_from_camera = poses[i];
  std::copy_n(all.begin(), edges_.size(), edges_.begin());
  if (!frames_.empty()) last_ = framePoses().back();
  closed_constraints_ = constraints_.size();
  return true;
}

std::vector<Pose> KeyframeGraph::framePoses() const {
  std::vector<Pose> poses;
  for (const AttachedFrame& f : frames_)
    poses.push_back(keyframes_[f.keyframe].world_from_camera * f.keyframe_from_camera);
  return poses;
}

}  // namespace rosefusion
