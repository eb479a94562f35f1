#include "engine/passes/raycast.h"

namespace rosefusion {

using namespace shader;

RaycastPass::RaycastPass(Device& device, const CameraIntrinsics& camera) : device_(device), camera_(camera) {
  const auto pixels = static_cast<std::uint64_t>(camera.size.x) * camera.size.y;
  vertices_ = Buffer(device, 16 * pixels, Memory::Device);
  normals_ = Buffer(device, 16 * pixels, Memory::Device);
  tiles_ = Buffer(device, sizeof(RaycastTile) * ((camera.size.x + kRaycastTile - 1) / kRaycastTile) *
                              ((camera.size.y + kRaycastTile - 1) / kRaycastTile), Memory::Device);
  preview_ = Buffer(device, 4 * pixels, Memory::Readback);
}

void RaycastPass::record(Recorder& recorder, const Volume& volume, const RaycastView& view) {
  Kernels& kernels = kernels_[volume.chunks()];
  if (!kernels.cast) {
    kernels.range = Kernel(device_, shaderCode("raycast_range"), kRaycastRangeBindings, sizeof(RaycastRangeParams), {volume.chunks()});
    kernels.cast = Kernel(device_, shaderCode("raycast"), kRaycastBindings, sizeof(RaycastParams), {volume.chunks()});
  }
  RaycastParams params{};
  params.world_from_camera = view.world_from_camera;
  params.focal_centre = camera_.focal_centre;
  params.size = glm::ivec4(camera_.size.x, camera_.size.y, view.colour && volume.options().colour, 0);
  const int tiles_x = (camera_.size.x + kRaycastTile - 1) / kRaycastTile;
  const int tiles_y = (camera_.size.y + kRaycastTile - 1) / kRaycastTile;
  params.size.w = tiles_x;
  const RaycastRangeParams range{glm::inverse(view.world_from_camera), camera_.focal_centre,
                                 glm::ivec4(tiles_x, tiles_y, static_cast<int>(volume.blockCount()), 0), view.near, view.far};
  if (solid_.bytes() < volume.table().bytes()) solid_ = Buffer(device_, volume.table().bytes(), Memory::Device);
  recorder.fill(tiles_, kEmptyTile, 0, tiles_.bytes());
  recorder.fill(solid_, 0, 0, solid_.bytes());
  const Buffer* range_buffers[kRaycastRangeBindings] = {&volume.layoutBuffer(), &volume.blockBuffer()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk)
    range_buffers[kRaycastRangeBindTsdf + chunk] = &volume.tsdf(chunk);
  range_buffers[kRaycastRangeBindTiles] = &tiles_;
  range_buffers[kRaycastRangeBindSolid] = &solid_;
  recorder.dispatchBytes(kernels.range, range_buffers, &range, sizeof(range), {volume.blockCount()});
  const Buffer* buffers[kRaycastBindings] = {&volume.layoutBuffer(), &volume.table()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk) {
    buffers[kRaycastBindTsdf + chunk] = &volume.tsdf(chunk);
    buffers[kRaycastBindWeight + chunk] = &volume.weight(chunk);
    buffers[kRaycastBindColour + chunk] = &volume.colour(chunk);
  }
  buffers[kRaycastBindVertices] = &vertices_;
  buffers[kRaycastBindNormals] = &normals_;
  buffers[kRaycastBindPreview] = &preview_;
  buffers[kRaycastBindTiles] = &tiles_;
  buffers[kRaycastBindSolid] = &solid_;
  recorder.dispatchBytes(kernels.cast, buffers, &params, sizeof(params),
                         {std::uint32_t(camera_.size.x), std::uint32_t(camera_.size.y)});
}

}  // namespace rosefusion
