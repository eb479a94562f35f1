// Passes preprocess and farthest: depth images onto the device, in metres and as points.
#pragma once
#include <cstdint>
#include <span>

#include "engine/depth_reach.h"
#include "engine/passes/footprint.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/farthest.h"
#include "shaders/compute/interface/preprocess.h"

namespace rosefusion {

/// One image size for life. Holds the current frame's depth, points and colour for the passes that follow.
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
  /// `rgb`: one word 0x00BBGGRR per pixel (red in the low byte). Copies at once: call between submits.
  void setColour(std::span<const std::uint32_t> rgb);

  const Buffer& depth() const { return depth_; }    ///< float metres per pixel, 0 = invalid
  const Buffer& points() const { return points_; }  ///< vec4 per pixel, camera frame, w = 1 where valid
  const Buffer& colour() const { return colour_; }
  /// After the submit: how far each part of the image sees.
  DepthReach reach() const;
  bool hasColour() const { return has_colour_; }
  void clearColour() { has_colour_ = false; }

 private:
  void recordKernel(Recorder& recorder, float metres_per_unit, float min_depth, float max_depth,
                    float edge_sigmas, const SensorNoise& noise, float voxel_size);

  Device& device_;
  shader::CameraIntrinsics camera_;
  Kernel kernel_, farthest_;
  FootprintPass footprint_;
  Buffer raw_, own_depth_, depth_, points_, tiles_, colour_;
  bool has_colour_ = false;
};

}  // namespace rosefusion
