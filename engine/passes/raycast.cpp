#include "engine/passes/raycast.h"

#include <algorithm>

namespace rosefusion {

using namespace shader;

const RaycastKernels::Pair& RaycastKernels::of(const VolumeView& volume) {
  Pair& pair = pairs_[volume.chunks()];
  if (!pair.cast) {
    pair.range = Kernel(device_, readerCode(device_, "raycast_range"), kRaycastRangeBindings,
                        sizeof(RaycastRangeParams), {volume.chunks()});
    pair.cast = Kernel(device_, readerCode(device_, "raycast"), kRaycastBindings, sizeof(RaycastParams),
                       {volume.chunks()});
  }
  return pair;
}

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
  const RaycastKernels::Pair& kernels = kernels_->of(volume);
  recordRange(recorder, kernels.range, volume, view);
  const int flags = (view.colour && volume.options().colour ? kRaycastColoured : 0) |
                    (view.clear ? kRaycastClear : 0) | (view.depth_value ? kRaycastDepth : 0);
  const RaycastParams params{view.world_from_camera, camera_.focal_centre,
                             glm::ivec4(camera_.size.x, camera_.size.y, flags, tiles_x_),
                             view.depth_value.value_or(glm::vec4(0))};
  const Buffer* buffers[kRaycastBindings] = {&volume.layoutBuffer(), &volume.table()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk) {
    buffers[kRaycastBindTsdf + chunk] = &volume.tsdf(chunk);
    buffers[kRaycastBindWeight + chunk] = &volume.weight(chunk);
    buffers[kRaycastBindColour + chunk] = &volume.colour(chunk);
  }
  buffers[kRaycastBindImages] = &images_;
  buffers[kRaycastBindTiles] = &tiles_;
  buffers[kRaycastBindSolid] = &solid_;
  recorder.dispatchBytes(kernels.cast, buffers, &params, sizeof(params),
                         {std::uint32_t(camera_.size.x), std::uint32_t(camera_.size.y)});
}

BufferPart RaycastPass::part(std::uint32_t words_before) const {
  const std::uint64_t pixel_bytes = images_.bytes() / kRaycastImageWords;
  return {images_, words_before * pixel_bytes, pixel_bytes};
}

std::span<const std::uint32_t> RaycastPass::preview() const {
  const std::size_t pixels = std::size_t(camera_.size.x) * camera_.size.y;
  return images_.as<std::uint32_t>().subspan(kRaycastPreviewAt * pixels, pixels);
}

void RaycastPass::recordRange(Recorder& recorder, const Kernel& kernel, const VolumeView& volume,
                              const RaycastView& view) {
  if (solid_.bytes() < volume.table().bytes())
    solid_ = Buffer(device_, volume.table().bytes(), Memory::Device);
  recorder.fill(tiles_, kEmptyTile, 0, tiles_.bytes());
  recorder.fill(solid_, 0, 0, solid_.bytes());
  // The shader compares depths as bits, which needs them positive.
  const RaycastRangeParams params{glm::inverse(view.world_from_camera), camera_.focal_centre,
                                  glm::ivec4(tiles_x_, tiles_y_, static_cast<int>(volume.blockCount()), 0),
                                  std::max(view.near, 0.0f), std::max(view.far, 0.0f)};
  const Buffer* buffers[kRaycastRangeBindings] = {&volume.layoutBuffer(), &volume.blockBuffer()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk)
    buffers[kRaycastRangeBindTsdf + chunk] = &volume.tsdf(chunk);
  buffers[kRaycastRangeBindTiles] = &tiles_;
  buffers[kRaycastRangeBindSolid] = &solid_;
  recorder.dispatchBytes(kernel, buffers, &params, sizeof(params), {volume.blockCount()});
}

}  // namespace rosefusion
