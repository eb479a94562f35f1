// The camera's path as the viewer shows it: how fast the camera went, and where it was by what is known now.
#pragma once
#include <optional>
#include <vector>

#include "host/slam/frame_result.h"

namespace rosefusion::viewer {

struct PathPoint {
  Eigen::Vector3d position;  ///< metres, world
  double speed = 0;          ///< m/s, since the point before
  bool connected = false;    ///< no frame was lost in between
};

/// One thread.
class ShownPath {
 public:
  /// What became of the next frame; `poses`: Pipeline::trajectory() after it, `seconds_per_stamp` as of
  /// SequenceInfo.
  void add(const FrameResult& result, const Trajectory& poses, double seconds_per_stamp);
  /// Takes over what poses became after they were told. False where there are none.
  bool correct(const Trajectory& poses);

  const std::vector<PathPoint>& points() const { return points_; }
  /// Of the last frame; none where it was lost.
  const std::optional<StampedPose>& last() const { return last_; }
  /// Since the frame before, m/s and rad/s; 0 where one of the two was lost.
  double speed() const { return speed_; }
  double turnRate() const { return turn_rate_; }

 private:
  std::vector<PathPoint> points_;
  std::optional<StampedPose> last_;
  double last_timestamp_ = 0;  ///< of the last frame, lost or not
  double speed_ = 0, turn_rate_ = 0;
};

}  // namespace rosefusion::viewer
