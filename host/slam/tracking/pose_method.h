// One way to find a frame's pose from what the frames before it tell.
#pragma once
#include "engine/device_frame.h"
#include "engine/volume.h"
#include "host/slam/tracking/search_observer.h"
#include "host/slam/tracking/track_history.h"

namespace rosefusion {

/// One thread.
class PoseMethod {
 public:
  virtual ~PoseMethod() = default;
  /// Pose of the frame held by `frame`, taken at `timestamp`. Changes nothing that the next frame's pose
  /// depends on but the random search's own numbers. The searches with particles tell `observer` of every
  /// iteration.
  virtual TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history,
                            double timestamp, const SearchObserver& observer = {}) = 0;
  /// Whether a lost camera is to be searched for in the whole map; else the next frame starts where the last
  /// one was.
  virtual bool relocalises() const { return false; }
};

}  // namespace rosefusion
