// The raycast_range pass as a C++ loop, a part of native_raycast.
#pragma once
#include <vector>

#include "engine/passes/raycast.h"
#include "host/bench/native_volume.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

/// The blocks in view that can stop a ray, and between which depths they lie for each tile of the image.
struct NativeRanges {
  std::vector<std::int32_t> solid;  ///< as NativeVolume::table, with these blocks only
  std::vector<glm::vec2> tiles;     ///< nearest and farthest depth, metres; empty: (0, 0)
  int columns = 0;
};

NativeRanges nativeRanges(const NativeVolume& volume, const shader::CameraIntrinsics& camera,
                          const RaycastView& view, int threads);

}  // namespace rosefusion
