// The camera's way, measured against what it saw lately and nothing else.
#pragma once
#include <functional>
#include <vector>

#include "host/slam/tracking/pose_refiner.h"

namespace rosefusion {

/// While old surfaces come into view, the tracker may slide from the new map onto the old one where the two
/// are shifted or turned against each other; then no comparison with the old map finds drift. Poses found
/// against recent keyframes alone keep it. One thread; the Device must outlive it.
class LocalOdometry {
 public:
  /// Fuses a keyframe, as if taken from there.
  using Fuse = std::function<void(std::size_t keyframe, Volume& volume, const Pose& world_from_camera)>;

  LocalOdometry(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                const VolumeOptions& volume, Fuse fuse);

  /// From the last of these keyframes on, of which `first` is the first one's number.
  void begin(std::size_t first, std::span<const Pose> keyframes);
  /// The next keyframe, held by `frame`, and its motion since the one before as it was tracked.
  void step(const DeviceFrame& frame, const Pose& last_from_camera);
  void end() { poses_.clear(); }
  /// Of the keyframes since begin(), the one that it began with included; empty after end().
  const std::vector<Pose>& poses() const { return poses_; }

 private:
  const RefineSettings settings_;
  Fuse fuse_;
  PoseRefiner refiner_;
  Volume recent_;
  std::vector<Pose> poses_;
  std::size_t next_ = 0;  ///< number of the next keyframe
};

}  // namespace rosefusion
