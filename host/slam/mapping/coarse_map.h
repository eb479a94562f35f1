// A coarse model of the keyframes, whose surfaces draw poses in from further away than the model's own: what
// a lost camera is looked for in from afar.
#pragma once
#include <functional>

#include "host/slam/mapping/frame_integrator.h"

namespace rosefusion {

/// One thread; the Device must outlive it.
class CoarseMap {
 public:
  CoarseMap(Device& device, const VolumeSettings& settings);

  /// Adds the frame that `fuser` holds.
  void add(FrameIntegrator& fuser, Recorder& recorder, const Pose& world_from_camera) {
    fuser.fuse(recorder, volume_, world_from_camera);
  }
  /// Voxels and truncation are several times those of the model proper. No colour.
  const Volume& volume() const { return volume_; }
  /// Its frames were moved: it is of no use until refresh().
  void expire() { expired_ = true; }
  /// Where it is expired, `rebuild` makes it anew.
  void refresh(const std::function<void(Volume&)>& rebuild);
  void clear();

 private:
  Volume volume_;
  bool expired_ = false;
};

}  // namespace rosefusion
