// Passes depth_moments and footprint: each pixel's depth as a voxel there sees it.
#pragma once
#include <array>

#include "engine/recorder.h"
#include "engine/sensor_noise.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/footprint.h"

namespace rosefusion {

/// One image size for life.
class FootprintPass {
 public:
  FootprintPass(Device& device, const shader::CameraIntrinsics& camera);

  /// `min_depth`, `max_depth`: metres; what a plane would give beyond is left as it was.
  /// `raw`: two 16-bit depths per word, 0 and 65535 being holes; `own`: float metres per pixel, 0 = invalid.
  /// Writes `depth`, the same as `own` but for the depths of what a voxel of `voxel_size` metres covers, and
  /// `points`, its camera-frame points (vec4 per pixel, w = 1 where valid).
  void record(Recorder& recorder, const Buffer& raw, const Buffer& own, const Buffer& depth,
              const Buffer& points, float voxel_size, const SensorNoise& noise, float min_depth,
              float max_depth);

 private:
  shader::CameraIntrinsics camera_;
  Kernel moments_, footprint_;
  std::array<Buffer, shader::kFootprintLevels> cells_;
};

}  // namespace rosefusion
