// From a depth image to the volume: what the device is to do, recorded step by step and submitted by the
// caller.
#pragma once
#include "engine/passes/allocate.h"
#include "engine/passes/integrate.h"
#include "engine/passes/preprocess.h"
#include "host/core/camera.h"
#include "host/core/frame.h"
#include "host/settings/settings.h"

namespace rosefusion {

/// What the settings ask of the model's volume.
VolumeOptions volumeOptions(const VolumeSettings& settings);

/// Holds the current frame on the device. recordSearch() and grow(), repeated while grow() says so, come
/// before recordFusion(); the search has run before its grow(), what that recorded before or with the fusion.
/// The Device must outlive it. One thread.
class FrameIntegrator {
 public:
  FrameIntegrator(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                  double depth_units_per_metre);

  /// What its passes need for this volume is made now, not inside the first frame; so it is elsewhere.
  void prepare(const VolumeView& volume) { integrate_.prepare(volume); }

  /// Copies the images at once. Throws InputError for a depth image of another size or type; colour of
  /// another size is left out.
  void recordFrame(Recorder& recorder, const Frame& frame);
  /// The same of depths that are on the device already, without colour.
  void recordFrame(Recorder& recorder, const DevicePixels& depth);
  /// Lists the voxel blocks that the frame needs.
  void recordSearch(Recorder& recorder, const Volume& volume, const Pose& world_from_camera);
  /// Gives the volume those blocks, for what is recorded next; see AllocatePass::finish().
  bool grow(Recorder& recorder, Volume& volume) { return allocate_.finish(recorder, volume); }
  void recordFusion(Recorder& recorder, const Volume& volume, const Pose& world_from_camera);
  /// All three for a frame that was recorded and submitted before; does not wait for the last.
  void fuse(Recorder& recorder, Volume& volume, const Pose& world_from_camera);

  const DeviceFrame& frame() const { return preprocess_.frame(); }

 private:
  template <typename Depth>
  void recordDepth(Recorder& recorder, const Depth& depth);

  Settings settings_;
  Intrinsics intrinsics_;
  double depth_units_per_metre_;
  PreprocessPass preprocess_;
  AllocatePass allocate_;
  IntegratePass integrate_;
};

}  // namespace rosefusion
