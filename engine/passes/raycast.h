// Pass raycast: the surface that a camera sees, as normals, depths and a shaded picture.
#pragma once
#include <memory>
#include <optional>
#include <span>

#include "engine/kernel_variants.h"
#include "engine/volume.h"
#include "shaders/compute/interface/camera.h"
#include "shaders/compute/interface/raycast.h"
#include "shaders/compute/interface/raycast_range.h"

namespace rosefusion {

/// From where to look, and how far: depths along the optical axis, metres.
struct RaycastView {
  glm::mat4 world_from_camera{1};
  float near = 0.05f;
  float far = 8.0f;
  bool colour = true;  ///< paint the preview in the volume's colours, where it has any
  bool clear = false;  ///< transparent black where nothing is hit, instead of a backdrop
  /// (a, b, c, d): the depth image holds a + b / z + c z for a hit at depth z, and d where there is none.
  /// Nothing: no depth image is written.
  std::optional<glm::vec4> depth_value;
};

/// The pipelines of the pass, for several of them to share; by number of pool chunks. One thread at a time.
struct RaycastKernels {
  explicit RaycastKernels(Device& device);
  /// Makes those for this volume now, not inside the first record().
  void prepare(const VolumeView& volume) {
    range.of(volume.chunks());
    cast.of(volume.chunks());
  }
  KernelVariants range, cast;
};

/// One camera for life. Holds the last view's images.
class RaycastPass {
 public:
  /// `images`: where they lie; with Memory::Device preview() cannot read them. `kernels`: null: its own.
  RaycastPass(Device& device, const shader::CameraIntrinsics& camera, Memory images = Memory::Readback,
              std::shared_ptr<RaycastKernels> kernels = nullptr);

  void record(Recorder& recorder, const VolumeView& volume, const RaycastView& view);

  /// Begins with two words per pixel, see kRaycastBindImages: packed normal and depth; both 0 where nothing
  /// was hit.
  const Buffer& surface() const { return images_; }
  /// float per pixel, see RaycastView::depth_value.
  BufferPart depth() const { return part(shader::kRaycastDepthAt); }
  /// One word 0xAABBGGRR per pixel (red in the low byte, alpha 255 or 0), sRGB.
  BufferPart picture() const { return part(shader::kRaycastPreviewAt); }
  /// After the submit: the picture on the host.
  std::span<const std::uint32_t> preview() const;

 private:
  void recordRange(Recorder& recorder, const VolumeView& volume, const RaycastView& view);
  BufferPart part(std::uint32_t words_before) const;

  Device& device_;
  shader::CameraIntrinsics camera_;
  int tiles_x_, tiles_y_;
  std::shared_ptr<RaycastKernels> kernels_;
  Buffer tiles_, solid_, images_;
};

}  // namespace rosefusion
