#include "engine/passes/raycast.h"

#include <algorithm>

namespace rosefusion {

using namespace shader;

RaycastKernels::RaycastKernels(Device& device)
    : range(device, readerCode(device, "raycast_range"), kRaycastRangeBindings, sizeof(RaycastRangeParams)),
      cast(device, readerCode(device, "raycast"), kRaycastBindings, sizeof(RaycastParams)) {}

RaycastPass::RaycastPass(Device& device, const CameraIntrinsics& camera, Memory images,
                         std::shared_ptr<RaycastKernels> kernels)
    : device_(device),
      camera_(camera),
      tiles_x_((camera.size.x + kRaycastTile - 1) / kRaycastTile),
      tiles_y_((camera.size.y + kRaycastTile - 1) / kRaycastTile),
      kernels_(kernels ? std::move(kernels) : std::make_shared<RaycastKernels>(device)) {
  const auto pixels = static_cast<std::uint64_t>(camera.size.x) * camera.size.y;
  tiles_ = Buffer(device, sizeof(RaycastTile) * tiles_x_ * tiles_y_, Memory::Device);
  images_ = Buffer(device, 4 * kRaycastImageWords * pixels, images);
}

void RaycastPass::record(Recorder& recorder, const VolumeView& volume, const RaycastView& view) {
  const Recorder::Whole whole(recorder);
  recordRange(recorder, volume, view);
  const int flags = (view.colour && volume.options().colour ? kRaycastColoured : 0) |
                    (view.clear ? kRaycastClear : 0) | (view.depth_value ? kRaycastDepth : 0);
  const RaycastParams params{view.world_from_camera, camera_.focal_centre,
                             glm::ivec4(camera_.size.x, camera_.size.y, flags, tiles_x_),
                             view.depth_value.value_or(glm::vec4(0))};
  recorder.dispatch(kernels_->cast.of(volume.chunks()),
                    {volume.layoutBuffer(), volume.table(), volume.tsdf(), volume.weight(), volume.colour(),
                     images_, tiles_, solid_},
                    params, Threads{std::uint32_t(camera_.size.x), std::uint32_t(camera_.size.y)});
}

BufferPart RaycastPass::part(std::uint32_t words_before) const {
  const std::uint64_t pixel_bytes = images_.bytes() / kRaycastImageWords;
  return {images_, words_before * pixel_bytes, pixel_bytes};
}

std::span<const std::uint32_t> RaycastPass::preview() const {
  const std::size_t pixels = std::size_t(camera_.size.x) * camera_.size.y;
  return images_.as<std::uint32_t>().subspan(kRaycastPreviewAt * pixels, pixels);
}

void RaycastPass::recordRange(Recorder& recorder, const VolumeView& volume, const RaycastView& view) {
  if (solid_.bytes() < volume.table().bytes())
    solid_ = Buffer(device_, volume.table().bytes(), Memory::Device);
  recorder.fill(tiles_, kEmptyTile, 0, tiles_.bytes());
  recorder.fill(solid_, 0, 0, solid_.bytes());
  // The shader compares depths as bits, which needs them positive.
  const RaycastRangeParams params{glm::inverse(view.world_from_camera), camera_.focal_centre,
                                  glm::ivec4(tiles_x_, tiles_y_, static_cast<int>(volume.blockCount()), 0),
                                  std::max(view.near, 0.0f), std::max(view.far, 0.0f)};
  recorder.dispatch(kernels_->range.of(volume.chunks()),
                    {volume.layoutBuffer(), volume.blockBuffer(), volume.tsdf(), tiles_, solid_}, params,
                    Threads{volume.blockCount()});
}

}  // namespace rosefusion
