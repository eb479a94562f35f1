// The preprocess pass as a multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "engine/sensor_noise.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

/// What PreprocessPass::record is told.
struct NativePreprocessing {
  shader::CameraIntrinsics camera;
  float metres_per_unit = 0.001f;
  float min_depth = 0, max_depth = 0;  ///< metres
  float edge_sigmas = 0;               ///< 0: edges are kept
  SensorNoise noise;
  float voxel_size = 0;  ///< metres; 0: every pixel keeps its own depth
};

/// As DeviceFrame has them.
struct NativeFrame {
  std::vector<float> depth;       ///< metres per pixel, 0 = invalid
  std::vector<glm::vec4> points;  ///< camera frame, w = 1 where valid
  std::vector<float> tiles;       ///< the largest depth of each tile of kFarthestTile pixels, row by row
};

/// `raw`: width x height depths, row by row. Fills `frame`, whose memory is used again.
void nativePreprocess(const NativePreprocessing& how, std::span<const std::uint16_t> raw, NativeFrame& frame,
                      int threads);

}  // namespace rosefusion
