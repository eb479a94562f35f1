// A map of its own, and what is known of the camera in it.
#pragma once
#include "host/slam/mapping/map.h"
#include "host/slam/mapping/model_start.h"
#include "host/slam/tracking_state.h"

namespace rosefusion {

/// One thread; the Device must outlive it.
struct Submap {
  Submap(Device& device, const Settings& settings, const Intrinsics& camera)
      : map(device, settings, camera) {}

  Map map;
  ModelStart start;
  InlierStatistics inlier_statistics;
  TrackingState state;
};

}  // namespace rosefusion
