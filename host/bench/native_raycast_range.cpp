#include "host/bench/native_raycast_range.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bench/native_loop.h"

namespace rosefusion {
namespace {

using shader::kBlockSide;
using shader::kBlockVoxels;

constexpr int kTile = shader::kRaycastTile;

/// Where a block's rectangle of tiles is, and how near and far it is.
struct BlockBounds {
  bool solid = false;
  glm::ivec2 low{0}, high{0};
  float nearest = 0, farthest = 0;
};

ROSEFUSION_INLINE void findNegative(const std::int16_t* codes, std::int32_t& found) {
  std::int32_t bits = 0;
  for (std::uint32_t i = 0; i < kBlockVoxels; ++i) bits |= codes[i];
  found = bits < 0;
}
ROSEFUSION_NATIVE(hasNegative, findNegative)

BlockBounds boundsOf(const NativeVolume& volume, const shader::CameraIntrinsics& camera,
                     const glm::mat4& view, float near, float far, glm::ivec2 tiles, std::size_t slot) {
  BlockBounds out;
  const float side = static_cast<float>(kBlockSide) * volume.voxel_size;
  std::array<glm::vec3, 8> corners;
  out.nearest = 1e30f;
  out.farthest = -1e30f;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner = (glm::vec3(volume.blocks[slot]) + glm::vec3(i & 1, i >> 1 & 1, i >> 2)) * side;
    corners[i] = glm::vec3(view * glm::vec4(corner, 1));
    out.nearest = std::min(out.nearest, corners[i].z);
    out.farthest = std::max(out.farthest, corners[i].z);
  }
  if (out.farthest < near || out.nearest > far) return out;
  const glm::vec2 focal(camera.focal_centre.x, camera.focal_centre.y),
      middle(camera.focal_centre.z, camera.focal_centre.w);
  out.high = tiles - 1;
  for (int axis = 0; axis < 2; ++axis) {
    const float end = static_cast<float>(tiles[axis] * kTile);
    bool before = true, beyond = true;
    float least = 1e30f, most = -1e30f;
    for (const glm::vec3& p : corners) {
      const float scaled = focal[axis] * p[axis] + middle[axis] * p.z;
      before = before && scaled < -p.z;
      beyond = beyond && scaled > end * p.z;
      least = std::min(least, scaled / p.z);
      most = std::max(most, scaled / p.z);
    }
    if (before || beyond) return out;
    if (out.nearest > near) {
      const auto tile = [&](float pixel) {
        return static_cast<int>(std::clamp(std::floor(pixel / static_cast<float>(kTile)), -1.0f,
                                           static_cast<float>(tiles[axis])));
      };
      out.low[axis] = std::max(tile(least), 0);
      out.high[axis] = std::min(tile(most), tiles[axis] - 1);
    }
    if (out.low[axis] > out.high[axis]) return out;
  }
  std::int32_t negative = 0;
  hasNegative(static_cast<const std::int16_t*>(&volume.codes[slot * kBlockVoxels]), negative);
  out.solid = negative != 0;
  out.nearest = std::max(out.nearest, near);
  out.farthest = std::min(out.farthest, far);
  return out;
}

}  // namespace

NativeRanges nativeRanges(const NativeVolume& volume, const shader::CameraIntrinsics& camera,
                          const RaycastView& view, int threads) {
  constexpr std::size_t kTogether = 64;  // blocks a thread takes at once
  const glm::mat4 camera_from_world = glm::inverse(view.world_from_camera);
  const glm::ivec2 tiles((camera.size.x + kTile - 1) / kTile, (camera.size.y + kTile - 1) / kTile);
  const float near = std::max(view.near, 0.0f), far = std::max(view.far, 0.0f);
  std::vector<BlockBounds> bounds(volume.blocks.size());
  inParallel(static_cast<std::uint32_t>(bounds.size() / kTogether + 1), threads, [&](std::uint32_t piece) {
    for (std::size_t slot = std::max<std::size_t>(piece * kTogether, 1);
         slot < std::min(bounds.size(), (piece + 1) * kTogether); ++slot)
      bounds[slot] = boundsOf(volume, camera, camera_from_world, near, far, tiles, slot);
  });
  NativeRanges out;
  out.columns = tiles.x;
  out.solid.assign(volume.table.size(), 0);
  out.tiles.assign(std::size_t(tiles.x) * tiles.y, glm::vec2(0));
  for (std::size_t slot = 1; slot < bounds.size(); ++slot) {
    const BlockBounds& b = bounds[slot];
    if (!b.solid) continue;
    const glm::ivec3 entry = glm::ivec3(volume.blocks[slot]) - volume.table_origin;
    out.solid[(std::size_t(entry.z) * volume.table_size.y + entry.y) * volume.table_size.x + entry.x] =
        static_cast<std::int32_t>(slot * kBlockVoxels);
    for (int y = b.low.y; y <= b.high.y; ++y)
      for (int x = b.low.x; x <= b.high.x; ++x) {
        glm::vec2& tile = out.tiles[std::size_t(y) * tiles.x + x];
        tile = tile.y == 0 ? glm::vec2(b.nearest, b.farthest)
                           : glm::vec2(std::min(tile.x, b.nearest), std::max(tile.y, b.farthest));
      }
  }
  return out;
}

}  // namespace rosefusion
