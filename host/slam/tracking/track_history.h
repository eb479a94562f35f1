// What the frames so far tell about the next one's pose.
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "host/core/frame.h"
#include "host/slam/tracking/motion_model.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

/// Seconds that a lost camera is expected where its motion leads.
inline constexpr double kCarriedOn = 1;

/// A value: asking it changes nothing.
struct TrackHistory {
  MotionModel motion;
  std::optional<CameraMotion> odometry;  ///< since `last`; see addOdometry()
  std::deque<double> costs;              ///< TrackResult::cost of the last frames
  std::optional<double> observed_ratio;  ///< of the last frame; none after a loss
  Pose last = Pose::Identity();          ///< of the last frame that has one
  bool tentative = false;                ///< `last` was not integrated and awaits more frames

  /// Odometry since the frame before, where another sensor has it. For every frame: motions are composed
  /// across lost frames until advance(); a frame without one discards their sum.
  void addOdometry(const std::optional<CameraMotion>& motion);
  /// The frame at `timestamp` has this pose; `found`: what the search for it said, if there was one.
  void advance(const Pose& world_from_camera, double timestamp, const std::optional<TrackResult>& found = {});
  /// The camera was lost: what comes next does not go on from the frames before.
  void interrupt();
  /// The map was corrected.
  void rebase(const Pose& new_from_old_world);

  /// Median cost of the last frames; none at the start and after a loss.
  std::optional<double> medianCost() const;
  /// Whether that is of as many frames as are ever remembered.
  bool remembersEnough() const;
  /// `otherwise`, with as much of it replaced as the odometry since `last` knows.
  Pose withOdometry(const Pose& otherwise) const;
  /// Where a lost camera may be, for all that is known of its motion: of `poses` the first `followed` are
  /// worth a closer look than others.
  struct Expected {
    std::vector<Pose> poses;
    std::size_t followed;
  };
  Expected expectedPoses(double timestamp) const;
};

}  // namespace rosefusion
