// The integrate pass as a multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <span>

#include "engine/sensor_noise.h"
#include "host/bench/native_volume.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

/// What IntegratePass::record is told. Colour is not fused.
struct NativeFusion {
  shader::CameraIntrinsics camera;
  glm::mat4 camera_from_world{1};
  SensorNoise noise;
  float truncation = 0;  ///< metres
  float max_weight = 0;
  bool thin_walls = false;
};

/// Fuses `depth` (metres per pixel, 0 = invalid) into the blocks of these slots: their codes and units; tsdf
/// stays as it was.
void nativeIntegrate(NativeVolume& volume, std::span<const std::uint32_t> slots, std::span<const float> depth,
                     const NativeFusion& fusion, int threads);

}  // namespace rosefusion
