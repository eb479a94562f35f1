// The raycast pass as a multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <vector>

#include "engine/passes/raycast.h"
#include "host/bench/native_volume.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

/// As RaycastPass writes them, pixel by pixel.
struct NativeView {
  std::vector<std::uint32_t> normals;  ///< as lib/direction.glsl packs them; 0 where nothing was hit
  std::vector<float> depth;            ///< along the optical axis, metres; 0 where nothing was hit
  std::vector<std::uint32_t> picture;  ///< red in the low byte
};

/// Of the view only pose, near and far are heeded: no colour, on a backdrop, no depth image. `truncation`: of
/// the volume, metres. Fills `out`, whose memory is used again.
void nativeRaycast(const NativeVolume& volume, float truncation, const shader::CameraIntrinsics& camera,
                   const RaycastView& view, NativeView& out, int threads);

}  // namespace rosefusion
