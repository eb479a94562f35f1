// Passes preprocess and farthest: depth images onto the device, in metres and as points.
#pragma once
#include <cstdint>
#include <span>

#include "engine/device_frame.h"
#include "engine/passes/footprint.h"
#include "engine/uploaded.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/farthest.h"
#include "shaders/compute/interface/preprocess.h"

namespace rosefusion {

/// One image size for life. Holds the current frame for the passes that follow.
class PreprocessPass {
 public:
  PreprocessPass(Device& device, const shader::CameraIntrinsics& camera);

  /// `raw`: width x height 16-bit depths, row by row; metres = value * metres_per_unit. `edge_sigmas` > 0
  /// drops pixels at edges, where a camera sees neither surface right: those that leave the plane of their
  /// neighbours by more than so many standard deviations of `noise`.
  void record(Recorder& recorder, std::span<const std::uint16_t> raw, float metres_per_unit, float min_depth,
              float max_depth, float edge_sigmas = 0, const SensorNoise& noise = {}, float voxel_size = 0);
  /// The same of depths that are on the device already.
  void record(Recorder& recorder, const DevicePixels& raw, float metres_per_unit, float min_depth,
              float max_depth, float edge_sigmas = 0, const SensorNoise& noise = {}, float voxel_size = 0);
  /// One word per pixel to fill, red in the low byte, then green and blue; the top byte is not read. Once
  /// what was recorded before has run; then recordColour().
  std::span<std::uint32_t> colourWords();
  void recordColour(Recorder& recorder);
  void clearColour() { frame_.has_colour = false; }
  const DeviceFrame& frame() const { return frame_; }

 private:
  void recordKernel(Recorder& recorder, float metres_per_unit, float min_depth, float max_depth,
                    float edge_sigmas, const SensorNoise& noise, float voxel_size);

  Device& device_;
  shader::CameraIntrinsics camera_;
  Kernel kernel_, farthest_;
  FootprintPass footprint_;
  Uploaded raw_, colour_;
  Buffer own_depth_;
  DeviceFrame frame_;
};

}  // namespace rosefusion
