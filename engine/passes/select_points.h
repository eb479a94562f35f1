// Passes select_count and select_points: the overlap set on a subsampling grid.
#pragma once
#include "engine/device_frame.h"
#include "engine/recorder.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/select_points.h"

namespace rosefusion {

/// Which pixels to look at: every stride-th, from (offset_x, offset_y) on.
struct PixelGrid {
  int stride = 8;
  int offset_x = 0;
  int offset_y = 0;
};

/// Holds the selected points on the device until the next record().
class SelectPointsPass {
 public:
  /// `parts`: of the grid that are looked at together, 0 chooses by the device. The points are the same.
  SelectPointsPass(Device& device, const shader::CameraIntrinsics& camera, std::uint32_t parts = 0);

  /// `previous_from_current` null: every valid pixel counts, not only those in the overlap with the last
  /// frame. Throws DeviceError (Programming) for a grid without a pixel in the image.
  void record(Recorder& recorder, const DeviceFrame& frame, const PixelGrid& grid,
              const glm::mat4* previous_from_current);

  const Buffer& points() const { return selected_; }  ///< vec4 camera-frame points
  const Buffer& count() const { return count_; }
  /// Pixels of the recorded grid: the most that can be selected, known before the submit.
  std::uint32_t cells() const { return cells_; }
  /// After the submit: points selected, and valid pixels of the grid.
  std::uint32_t selected() const { return told_.as<std::uint32_t>()[0]; }
  std::uint32_t valid() const { return told_.as<std::uint32_t>()[1]; }

 private:
  Device& device_;
  shader::CameraIntrinsics camera_;
  std::uint32_t parts_;
  Kernel count_parts_, kernel_;
  Buffer counts_, selected_, count_, told_;
  std::uint32_t cells_ = 0;
};

}  // namespace rosefusion
