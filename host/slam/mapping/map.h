// What the frames so far have made: the model, and what a camera is found in it by.
#pragma once
#include "host/core/trajectory.h"
#include "host/slam/mapping/coarse_map.h"
#include "host/slam/mapping/free_space.h"
#include "host/slam/mapping/keyframes.h"
#include "host/slam/mapping/open_stretches.h"

namespace rosefusion {

/// One thread; the Device must outlive it.
struct Map {
  Map(Device& device, const Settings& settings, const Intrinsics& camera);
  Map(const Map&) = delete;

  Volume volume;
  CoarseMap coarse;  ///< of the keyframes
  Keyframes keyframes;
  KnownFreeSpace free_space;     ///< of the keyframes
  Trajectory trajectory;         ///< of the frames that have a pose
  OpenStretches open_stretches;  ///< of the trajectory

  /// A pose that became known late, at its time: those behind it come one later. Returns its number.
  std::size_t insert(const StampedPose& pose);
  /// A closed loop has corrected all poses of `trajectory`. volume and coarse are to be made anew.
  void move(std::span<const Pose> corrected);
  void clear();
};

}  // namespace rosefusion
