#include "host/slam/tracking/tracker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace rosefusion {
namespace {

constexpr std::size_t kRememberedCosts = 9;  // frames
// A frame's cost is suspicious beyond this factor of the recent ones' median, and this much more.
constexpr double kSuspiciousFactor = 1.3, kSuspiciousExcess = 0.05;
// What no search brings below this is a jump. Right poses of flights and recordings exceed the median by up
// to 0.21, a wrong one after 30 missing frames by 0.42
// (tests/bench/notes/relocalisation.md#found-where-its-motion-leads-and-slides-that-show).
constexpr double kJumpExcess = 0.3;
// What the model knows of the view does not shrink by more from one frame to the next: of 66 000 tracked
// frames one lost 0.38 of it and no other 0.2; a hand takes a half, and may fit a wall elsewhere
// (tests/bench/notes/relocalisation.md).
constexpr double kSuddenlyUnknown = 0.3;

constexpr double kCarriedOn = 1;  // seconds that a lost camera is expected where its motion leads

/// 0 for the expected pose, towards 1 beyond some centimetres or degrees.
double motionPriorCost(const Pose& pose, const Pose& expected) {
  constexpr double kShift = 0.05, kTurn = 0.1;
  const double shift = shiftBetween(pose, expected) / kShift;
  const double turn = turnInWorld(expected, pose).angle() / kTurn;
  return 1 - std::exp(-0.5 * (shift * shift + std::pow(turn, 2)));
}

}  // namespace

Tracker::Tracker(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                 TemplateSet templates)
    : settings_(settings),
      search_(device, settings, intrinsics, std::move(templates)),
      refiner_(device, settings, intrinsics) {}

void Tracker::search(const PreprocessPass& frame, const Volume& volume, const Pose& start,
                     TrackResult& result) {
  const SwarmResult found = search_.search(frame, volume, start, state_.last, observer_);
  result.world_from_camera = found.world_from_camera;
  result.iterations += found.iterations;
  result.lookups += found.lookups;
}

std::optional<double> Tracker::medianCost() const {
  if (state_.costs.empty()) return {};
  std::vector<double> sorted(state_.costs.begin(), state_.costs.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

void Tracker::TrackState::addOdometry(const std::optional<CameraMotion>& by) {
  if (!by) odometry.reset();
  if (!odometry) return;
  odometry->last_camera_from_camera = odometry->last_camera_from_camera * by->last_camera_from_camera;
  odometry->has_translation = odometry->has_translation && by->has_translation;
}

void Tracker::addOdometry(const std::optional<CameraMotion>& motion) {
  state_.addOdometry(motion);
  if (before_tentative_) before_tentative_->addOdometry(motion);
}

Pose Tracker::withOdometry(const Pose& otherwise) const {
  if (!state_.odometry) return otherwise;
  Pose moved_pose = state_.last * state_.odometry->last_camera_from_camera;
  if (!state_.odometry->has_translation) moved_pose.translation() = otherwise.translation();
  return moved_pose;
}

TrackResult Tracker::track(const PreprocessPass& frame, const Volume& volume, double timestamp) {
  if (other_method_) return other_method_->track(frame, volume, state_.last, observer_);
  TrackResult result;
  const RefineSettings& s = settings_.refine;
  const Pose predicted = state_.motion.predict(timestamp), expected = withOdometry(predicted);
  PoseFit best;
  double best_cost = 2;
  // Around a tentative pose the model does not grow, and most of the view may be unknown: a shift
  // that makes a little more of it known must not win over one that puts more onto the surfaces.
  const auto misfit = [&](const PoseFit& fit) {
    return (before_tentative_ ? 1 - fit.inlier_ratio : fit.cost) + fit.colour_cost;
  };
  const auto refineFrom = [&](const std::vector<Pose>& starts) {
    for (const PoseFit& fit : refiner_.refine(volume, starts, s.coarse_iterations, expected)) {
      const double cost =
          misfit(fit) + s.motion_preference * motionPriorCost(fit.world_from_camera, expected);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = fit;
    }
  };
  const auto searchFrom = [&](const Pose& start) {
    search(frame, volume, start, result);
    refineFrom({result.world_from_camera});
  };
  refiner_.selectPixels(frame, s.coarse_pixel_stride, state_.last);
  refineFrom(state_.odometry ? std::vector<Pose>{expected, state_.last, predicted}
                             : std::vector<Pose>{expected, state_.last});
  searchFrom(best.world_from_camera);  // ends after max_empty_sets iterations where nothing better is near
  const std::optional<double> usual = medianCost();
  if (!usual || best.cost > kSuspiciousFactor * *usual + kSuspiciousExcess) {
    searchFrom(expected);
    searchFrom(state_.last);
  }
  const bool has_odometry = state_.odometry && state_.odometry->has_translation;
  state_.costs.push_back(best.cost);
  if (state_.costs.size() > kRememberedCosts) state_.costs.pop_front();

  refiner_.selectPixels(frame, s.pixel_stride, state_.last);
  result.fit = refiner_.refine(volume, std::vector<Pose>{best.world_from_camera}, s.iterations, expected)[0];
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner_.takePointsRead();
  result.jump =
      (usual && best.cost > *usual + kJumpExcess) ||
      (state_.observed_ratio && result.fit->observed_ratio < *state_.observed_ratio - kSuddenlyUnknown) ||
      (!has_odometry && state_.motion.isInterrupted(timestamp));
  state_.observed_ratio = result.fit->observed_ratio;
  return result;
}

Tracker::Expected Tracker::expectedPoses(double timestamp) const {
  const bool soon = state_.motion.secondsSince(timestamp) <= kCarriedOn;
  std::vector<Pose> poses;
  if (state_.odometry) poses.push_back(withOdometry(state_.last));
  if (soon) poses.push_back(state_.motion.predict(timestamp, kCarriedOn));
  poses.push_back(state_.last);
  return {poses, poses.size() - (soon ? 0 : 1)};
}

void Tracker::TrackState::advance(const Pose& world_from_camera, double timestamp) {
  if (lost) {
    costs.clear();
    observed_ratio.reset();
    motion.forget();
  }
  lost = false;
  odometry = CameraMotion{Pose::Identity(), true};
  motion.add(world_from_camera, timestamp);
  last = world_from_camera;
}

void Tracker::TrackState::rebase(const Pose& new_from_old_world) {
  motion.rebase(new_from_old_world);
  last = new_from_old_world * last;
}

void Tracker::accept(const Pose& world_from_camera, double timestamp) {
  before_tentative_.reset();
  state_.advance(world_from_camera, timestamp);
}

void Tracker::setTentative(const Pose& world_from_camera, double timestamp) {
  if (!before_tentative_) before_tentative_ = state_;
  state_.advance(world_from_camera, timestamp);
}

void Tracker::rebase(const Pose& world_from_last) {
  const Pose new_from_old = world_from_last * state_.last.inverse();
  state_.rebase(new_from_old);
  if (before_tentative_) before_tentative_->rebase(new_from_old);
}

void Tracker::setLost() {
  if (before_tentative_) state_ = *std::exchange(before_tentative_, std::nullopt);
  state_.lost = !other_method_;
}

}  // namespace rosefusion
