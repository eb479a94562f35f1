// Pass integrate: fuses the current depth image into the volume.
#pragma once
#include <vector>

#include "engine/device_frame.h"
#include "engine/kernel_variants.h"
#include "engine/sensor_noise.h"
#include "engine/volume.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/integrate.h"

namespace rosefusion {

class IntegratePass {
 public:
  explicit IntegratePass(Device& device);
  /// Makes the kernels now, not inside the first record(): a model of colours also fuses frames without.
  void prepare(const VolumeView& volume) {
    for (const bool colour : {false, true})
      if (!colour || volume.options().colour) kernels_.of(volume.chunks(), colour);
  }

  /// Updates all allocated blocks that the camera can see up to `far` metres and that no surface of the frame
  /// hides. The frame's own submit must have ended, and the blocks around the surface must have been
  /// allocated (AllocatePass). A depth weighs (floor / deviation)^2 of `noise`.
  void record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
              const shader::CameraIntrinsics& camera, const glm::mat4& camera_from_world, float far,
              const SensorNoise& noise = {});
  /// Recorded last.
  std::size_t blocks() const { return slots_.size(); }

 private:
  Device& device_;
  KernelVariants kernels_;  ///< by number of pool chunks, and whether colour is fused
  std::vector<std::uint32_t> slots_;
  Buffer visible_;
};

}  // namespace rosefusion
