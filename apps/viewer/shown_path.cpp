#include "apps/viewer/shown_path.h"

#include <algorithm>

namespace rosefusion::viewer {

void ShownPath::add(const FrameResult& result, const Trajectory& poses, double seconds_per_stamp) {
  if (result.loop || result.stretch_closed) correct(poses);
  if (result.began_anew) {
    points_.assign(1, {Eigen::Vector3d::Zero(), 0, false});
    last_ = StampedPose{last_timestamp_, Pose::Identity()};
  }
  last_timestamp_ = result.timestamp;
  speed_ = turn_rate_ = 0;
  for (const RecoveredPose& recovered : result.recovered)
    points_.insert(points_.begin() + static_cast<std::ptrdiff_t>(std::min(recovered.number, points_.size())),
                   {recovered.pose.world_from_camera.translation(), 0, false});
  if (result.status == TrackingStatus::Lost) return last_.reset();
  const StampedPose now{result.timestamp, result.world_from_camera};
  const double seconds = last_ ? (now.timestamp - last_->timestamp) * seconds_per_stamp : 0;
  if (seconds > 0) {
    const Pose moved = last_->world_from_camera.inverse() * now.world_from_camera;
    speed_ = moved.translation().norm() / seconds;
    turn_rate_ = rotationAngle(moved) / seconds;
  }
  points_.push_back({now.world_from_camera.translation(), speed_, seconds > 0});
  last_ = now;
}

bool ShownPath::correct(const Trajectory& poses) {
  if (poses.empty() || points_.empty()) return false;
  const std::size_t known = std::min(points_.size(), poses.size());
  for (std::size_t i = 0; i < known; ++i) points_[i].position = poses[i].world_from_camera.translation();
  if (last_) last_ = poses[known - 1];
  return true;
}

}  // namespace rosefusion::viewer
