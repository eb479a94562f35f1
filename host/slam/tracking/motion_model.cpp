#include "host/slam/tracking/motion_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace rosefusion {
namespace {

constexpr double kLongestInterval = 0.2;  // seconds, between poses that make a velocity
// A pause of so many of the usual intervals, and of so many seconds, in which the camera may have gone
// anywhere.
constexpr double kPauseIntervals = 5, kPause = 0.25;

}  // namespace

void MotionModel::add(const Pose& world_from_camera, double timestamp) {
  before_ = last_;
  if (before_ && !(before_->timestamp < timestamp)) before_.reset();
  last_ = {world_from_camera, timestamp};
}

void MotionModel::rebase(const Pose& new_from_old_world) {
  for (std::optional<Stamped>* pose : {&last_, &before_})
    if (*pose) (*pose)->world_from_camera = new_from_old_world * (*pose)->world_from_camera;
}

double MotionModel::secondsSince(double timestamp) const {
  return last_ ? timestamp - last_->timestamp : std::numeric_limits<double>::infinity();
}

bool MotionModel::isInterrupted(double timestamp) const {
  if (!before_) return false;
  const double passed = timestamp - last_->timestamp;
  return passed > kPause && passed > kPauseIntervals * (last_->timestamp - before_->timestamp);
}

std::optional<Velocity> MotionModel::velocity() const {
  if (!before_) return {};
  const double passed = last_->timestamp - before_->timestamp;
  if (passed > kLongestInterval) return {};
  // A turn by a constant rate leaves its own axis where it is.
  const Eigen::Matrix3d camera_from_world = last_->world_from_camera.linear().transpose();
  const Eigen::AngleAxisd turn = turnInWorld(before_->world_from_camera, last_->world_from_camera);
  const Eigen::Vector3d shift =
      last_->world_from_camera.translation() - before_->world_from_camera.translation();
  return Velocity{camera_from_world * shift / passed,
                  camera_from_world * (turn.angle() / passed * turn.axis())};
}

Pose MotionModel::predict(double timestamp, double longest) const {
  if (!last_) return Pose::Identity();
  Pose out = last_->world_from_camera;
  if (!before_) return out;
  const double passed = last_->timestamp - before_->timestamp;
  if (passed > kLongestInterval) return out;
  const double share = std::clamp(timestamp - last_->timestamp, 0.0, longest) / passed;
  out.translation() += share * (out.translation() - before_->world_from_camera.translation());
  const Eigen::AngleAxisd turn = turnInWorld(before_->world_from_camera, out);
  out.linear() = (Eigen::Quaterniond(Eigen::AngleAxisd(share * turn.angle(), turn.axis())) *
                  Eigen::Quaterniond(out.linear()))
                     .normalized()
                     .toRotationMatrix();
  return out;
}

}  // namespace rosefusion
