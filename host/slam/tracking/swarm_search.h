// The random search for a frame's pose: the swarm's losses from the device, its update on the host [Algorithm
// pfopst].
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/slam/tracking/particle_evaluator.h"
#include "host/slam/tracking/pose_estimate.h"
#include "host/slam/tracking/search_observer.h"
#include "host/swarm/swarm_update.h"

namespace rosefusion {

/// The best particle of a template, which is no fit yet.
struct ScannedPose {
  Pose world_from_camera = Pose::Identity();
  double loss = 1;
  std::uint64_t lookups = 0;  ///< TSDF lookups spent
};

/// Owns the swarm templates on the device and the swarm's state from frame to frame. One thread.
class SwarmSearch {
 public:
  /// Throws InputError when the template set does not fit settings.swarm.levels.
  SwarmSearch(Device& device, const Settings& settings, const Intrinsics& intrinsics, TemplateSet templates);

  void prepare(const VolumeView& volume);
  /// Pose of the frame held by `frame`, searched from `start`; `last`: the last frame's pose, for the
  /// overlap.
  TrackResult search(const DeviceFrame& frame, const Volume& volume, const Pose& start, const Pose& last,
                     const SearchObserver& observer = {});
  /// The best particle of one wide template around each pose, over every valid pixel of a coarse grid: for
  /// poses that may be far off. Axis lengths in metres and of the quaternion's imaginary part.
  std::vector<ScannedPose> scan(const DeviceFrame& frame, const Volume& volume, std::span<const Pose> poses,
                                double shift, double turn);
  /// Fit of the frame at a pose; every 8th pixel, all of them counted for the shares. Recorded with other
  /// work, and read once that has run.
  void recordScore(Recorder& recorder, const DeviceFrame& frame, const Volume& volume,
                   const Pose& world_from_camera, const Pose& last);
  PoseScore recordedScore() const;
  /// Both, and waits.
  PoseScore score(const DeviceFrame& frame, const Volume& volume, const Pose& world_from_camera,
                  const Pose& last);
  const TemplateSet& templates() const { return templates_; }

 private:
  const Settings settings_;
  TemplateSet templates_;
  std::vector<std::uint32_t> level_offsets_;  ///< first particle of each level's first template on the device
  ParticleEvaluator evaluator_;
  std::optional<SwarmState> previous_;
};

}  // namespace rosefusion
