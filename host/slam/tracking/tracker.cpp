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
// What no search brings below this is doubtful. Right poses of flights and recordings exceed the median by up
// to 0.21, a wrong one after 30 missing frames by 0.42 (tests/bench/NOTES.md).
constexpr double kDoubtfulExcess = 0.3;
// What the model knows of the view does not shrink by more from one frame to the next: of 66 000 tracked
// frames one lost 0.38 of it and no other 0.2; a hand takes a half, and may fit a wall elsewhere (NOTES.md).
constexpr double kSuddenlyUnknown = 0.3;

constexpr double kCarriedOn = 1;  // seconds that a lost camera is expected where its motion leads

/// 0 for the expected pose, towards 1 beyond some centimetres or degrees.
double unexpectedness(const Pose& pose, const Pose& expected) {
  constexpr double kShift = 0.05, kTurn = 0.1;
  const double shift = (pose.translation() - expected.translation()).norm() / kShift;
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose.linear() * expected.linear().transpose()));
  return 1 - std::exp(-0.5 * (shift * shift + std::pow(turn.angle() / kTurn, 2)));
}

}  // namespace

Tracker::Tracker(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                 TemplateSet templates)
    : settings_(settings),
      search_(device, settings, intrinsics, std::move(templates)),
      refiner_(device, settings, intrinsics) {}

void Tracker::search(const PreprocessPass& frame, const Volume& volume, const Pose& start,
                     TrackResult& result) {
  const SwarmResult found = search_.search(frame, volume, start, course_.last, observer_);
  result.world_from_camera = found.world_from_camera;
  result.iterations += found.iterations;
  result.lookups += found.lookups;
}

std::optional<double> Tracker::usualCost() const {
  if (course_.costs.empty()) return {};
  std::vector<double> sorted(course_.costs.begin(), course_.costs.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

void Tracker::Course::move(const std::optional<CameraMotion>& by) {
  if (!by) told.reset();
  if (!told) return;
  told->last_camera_from_camera = told->last_camera_from_camera * by->last_camera_from_camera;
  told->has_translation = told->has_translation && by->has_translation;
}

void Tracker::move(const std::optional<CameraMotion>& motion) {
  course_.move(motion);
  if (accepted_) accepted_->move(motion);
}

Pose Tracker::asTold(const Pose& otherwise) const {
  if (!course_.told) return otherwise;
  Pose told = course_.last * course_.told->last_camera_from_camera;
  if (!course_.told->has_translation) told.translation() = otherwise.translation();
  return told;
}

TrackResult Tracker::track(const PreprocessPass& frame, const Volume& volume, double timestamp) {
  if (other_method_) return other_method_->track(frame, volume, course_.last, observer_);
  TrackResult result;
  const RefineSettings& s = settings_.refine;
  const Pose predicted = course_.motion.predict(timestamp), expected = asTold(predicted);
  PoseFit best;
  double best_cost = 2;
  // Around a pose that is only supposed the model does not grow, and most of the view may be unknown: a shift
  // that makes a little more of it known must not win over one that puts more onto the surfaces.
  const auto misfit = [&](const PoseFit& fit) {
    return (accepted_ ? 1 - fit.close : fit.cost) + fit.colour_cost;
  };
  const auto descendFrom = [&](const std::vector<Pose>& starts) {
    for (const PoseFit& fit : refiner_.refine(volume, starts, s.coarse_iterations, expected)) {
      const double cost = misfit(fit) + s.motion_preference * unexpectedness(fit.world_from_camera, expected);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = fit;
    }
  };
  const auto searchFrom = [&](const Pose& start) {
    search(frame, volume, start, result);
    descendFrom({result.world_from_camera});
  };
  refiner_.look(frame, s.coarse_pixel_stride, course_.last);
  descendFrom(course_.told ? std::vector<Pose>{expected, course_.last, predicted}
                           : std::vector<Pose>{expected, course_.last});
  searchFrom(best.world_from_camera);  // ends after max_empty_sets iterations where nothing better is near
  const std::optional<double> usual = usualCost();
  if (!usual || best.cost > kSuspiciousFactor * *usual + kSuspiciousExcess) {
    searchFrom(expected);
    searchFrom(course_.last);
  }
  const bool told = course_.told && course_.told->has_translation;
  course_.costs.push_back(best.cost);
  if (course_.costs.size() > kRememberedCosts) course_.costs.pop_front();

  refiner_.look(frame, s.pixel_stride, course_.last);
  result.fit = refiner_.refine(volume, std::vector<Pose>{best.world_from_camera}, s.iterations, expected)[0];
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner_.takePointsRead();
  result.doubtful = (usual && best.cost > *usual + kDoubtfulExcess) ||
                    (course_.usable && result.fit->usable < *course_.usable - kSuddenlyUnknown) ||
                    (!told && course_.motion.isInterrupted(timestamp));
  course_.usable = result.fit->usable;
  return result;
}

Tracker::Expected Tracker::expectedPoses(double timestamp) const {
  const bool soon = course_.motion.secondsSince(timestamp) <= kCarriedOn;
  std::vector<Pose> poses;
  if (course_.told) poses.push_back(asTold(course_.last));
  if (soon) poses.push_back(course_.motion.predict(timestamp, kCarriedOn));
  poses.push_back(course_.last);
  return {poses, poses.size() - (soon ? 0 : 1)};
}

void Tracker::Course::goOn(const Pose& world_from_camera, double timestamp) {
  if (lost) {
    costs.clear();
    usable.reset();
    motion.forget();
  }
  lost = false;
  told = CameraMotion{Pose::Identity(), true};
  motion.add(world_from_camera, timestamp);
  last = world_from_camera;
}

void Tracker::Course::rebase(const Pose& new_from_old_world) {
  motion.rebase(new_from_old_world);
  last = new_from_old_world * last;
}

void Tracker::accept(const Pose& world_from_camera, double timestamp) {
  accepted_.reset();
  course_.goOn(world_from_camera, timestamp);
}

void Tracker::suppose(const Pose& world_from_camera, double timestamp) {
  if (!accepted_) accepted_ = course_;
  course_.goOn(world_from_camera, timestamp);
}

void Tracker::rebase(const Pose& world_from_last) {
  const Pose new_from_old = world_from_last * course_.last.inverse();
  course_.rebase(new_from_old);
  if (accepted_) accepted_->rebase(new_from_old);
}

void Tracker::lose() {
  if (accepted_) course_ = *std::exchange(accepted_, std::nullopt);
  course_.lost = !other_method_;
}

}  // namespace rosefusion
