#include "host/slam/tracking/track_history.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr std::size_t kRememberedCosts = 9;  // frames

}  // namespace

void TrackHistory::addOdometry(const std::optional<CameraMotion>& by) {
  if (!by) odometry.reset();
  if (!odometry) return;
  odometry->last_camera_from_camera = odometry->last_camera_from_camera * by->last_camera_from_camera;
  odometry->has_translation = odometry->has_translation && by->has_translation;
}

void TrackHistory::advance(const Pose& world_from_camera, double timestamp,
                           const std::optional<TrackResult>& found) {
  if (found && found->cost) {
    costs.push_back(*found->cost);
    if (costs.size() > kRememberedCosts) costs.pop_front();
    observed_ratio = found->fit->observed_ratio;
  }
  odometry = CameraMotion{Pose::Identity(), true};
  motion.add(world_from_camera, timestamp);
  last = world_from_camera;
}

void TrackHistory::interrupt() {
  costs.clear();
  observed_ratio.reset();
  motion.forget();
}

void TrackHistory::rebase(const Pose& new_from_old_world) {
  motion.rebase(new_from_old_world);
  last = new_from_old_world * last;
}

std::optional<double> TrackHistory::medianCost() const {
  if (costs.empty()) return {};
  std::vector<double> sorted(costs.begin(), costs.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

bool TrackHistory::remembersEnough() const {
  return costs.size() == kRememberedCosts;
}

Pose TrackHistory::withOdometry(const Pose& otherwise) const {
  if (!odometry) return otherwise;
  Pose moved_pose = last * odometry->last_camera_from_camera;
  if (!odometry->has_translation) moved_pose.translation() = otherwise.translation();
  return moved_pose;
}

TrackHistory::Expected TrackHistory::expectedPoses(double timestamp) const {
  const bool soon = motion.secondsSince(timestamp) <= kCarriedOn;
  std::vector<Pose> poses;
  if (odometry) poses.push_back(withOdometry(last));
  if (soon) poses.push_back(motion.predict(timestamp, kCarriedOn));
  poses.push_back(last);
  return {poses, poses.size() - (soon ? 0 : 1)};
}

}  // namespace rosefusion
