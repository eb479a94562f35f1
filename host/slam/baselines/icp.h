// The classical yardstick: iterative closest points, point to plane, of a frame against the surface that the
// last frame's camera sees in the model; the recipe of KinectFusion (Newcombe et al. 2011) on the raw depth.
#pragma once
#include "engine/passes/icp.h"
#include "host/core/camera.h"
#include "host/settings/settings.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

/// One thread.
class Icp {
 public:
  Icp(Device& device, const Settings& settings, const Intrinsics& intrinsics);

  /// Starts at `last`, from where the model is cast. Ends early where the pairs leave a direction open.
  TrackResult align(const DeviceFrame& frame, const Volume& volume, const Pose& last);

 private:
  const IcpSettings settings_;
  const float far_;
  Recorder recorder_;
  RaycastPass raycast_;
  IcpPass icp_;
};

}  // namespace rosefusion
