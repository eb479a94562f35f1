#include "apps/viewer/view_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rosefusion::viewer {
namespace {

constexpr double kSettling = 0.12;                          // seconds for two thirds of the way
constexpr double kHalfAngle = std::numbers::pi / 6;         // half the vertical angle of view
constexpr double kMostElevation = 0.49 * std::numbers::pi;  // straight down has no "up" in the picture
constexpr double kNearest = 0.2, kFarthest = 200;           // metres
constexpr double kBehind = 1.2, kAbove = 0.5;               // of the tracked camera, metres

Pose lookingFrom(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) {
  const Eigen::Vector3d forward = (at - eye).normalized();
  const Eigen::Vector3d right = forward.cross(-Eigen::Vector3d::UnitY()).normalized();
  Pose pose = Pose::Identity();
  pose.linear() << right, forward.cross(right), forward;
  pose.translation() = eye;
  return pose;
}

}  // namespace

const char* toString(ViewMode mode) {
  return mode == ViewMode::Orbit ? "Orbit" : mode == ViewMode::Follow ? "Follow" : "First person";
}

void ViewCamera::turn(double right, double down) {
  azimuth_ += right;
  elevation_ = std::clamp(elevation_ + down, -kMostElevation, kMostElevation);
}

void ViewCamera::zoom(double factor) {
  distance_ = std::clamp(distance_ / factor, kNearest, kFarthest);
}

void ViewCamera::pan(double right, double down) {
  centre_ -= distance_ * (right * pose_.linear().col(0) + down * pose_.linear().col(1));
}

void ViewCamera::frame(const Eigen::Vector3d& centre, double radius) {
  centre_ = centre;
  distance_ = std::clamp(radius / std::sin(kHalfAngle), kNearest, kFarthest);
}

Pose ViewCamera::goal(const Pose& tracked) const {
  if (mode_ == ViewMode::FirstPerson) return tracked;
  if (mode_ == ViewMode::Follow) {
    Pose behind = tracked;
    behind.translation() += tracked.linear() * Eigen::Vector3d(0, -kAbove, -kBehind);
    return behind;
  }
  const Eigen::Vector3d from_centre(-std::sin(azimuth_) * std::cos(elevation_), -std::sin(elevation_),
                                    -std::cos(azimuth_) * std::cos(elevation_));
  return lookingFrom(centre_ + distance_ * from_centre, centre_);
}

void ViewCamera::advance(const Pose& tracked, double seconds) {
  const Pose to = goal(tracked);
  const double share = 1 - std::exp(-seconds / kSettling);
  const Eigen::Quaterniond from_turn(pose_.linear()), to_turn(to.linear());
  const bool arrived =
      (to.translation() - pose_.translation()).norm() < 1e-3 && from_turn.angularDistance(to_turn) < 1e-3;
  if (arrived) {
    pose_ = to;
    return;
  }
  pose_.linear() = from_turn.slerp(share, to_turn).normalized().toRotationMatrix();
  pose_.translation() += share * (to.translation() - pose_.translation());
}

void ViewCamera::jump(const Pose& tracked) {
  pose_ = goal(tracked);
}

Intrinsics ViewCamera::intrinsics(int width, int height, const Intrinsics& tracked) const {
  double focal = height / 2.0 / std::tan(kHalfAngle);
  if (mode_ == ViewMode::FirstPerson && tracked.width > 0) focal = tracked.fx * height / tracked.height;
  return {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
}

}  // namespace rosefusion::viewer
