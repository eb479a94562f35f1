// One way to find a frame's pose from the last frame's.
#pragma once
#include "engine/passes/preprocess.h"
#include "engine/volume.h"
#include "host/slam/tracking/pose_estimate.h"
#include "host/slam/tracking/search_observer.h"

namespace rosefusion {

/// One thread.
class PoseMethod {
 public:
  virtual ~PoseMethod() = default;
  /// Pose of the frame held by `frame`, searched from `last`, the last frame's. The searches with particles
  /// tell `observer` of every iteration.
  virtual TrackResult track(const PreprocessPass& frame, const Volume& volume, const Pose& last,
                            const SearchObserver& observer = {}) = 0;
};

}  // namespace rosefusion
