#include "host/bench/native_integrate.h"

#include <algorithm>
#include <cmath>

#include "host/bench/native_loop.h"

namespace rosefusion {
namespace {

using shader::kBlockSide;
using shader::kBlockVoxels;
using shader::kWeightOne;

// Views whose distances differ by more contradict each other: deviations of the noise, voxels.
constexpr float kDeviations = 4, kVoxels = 0.5f;
constexpr float kNearest = 0.4f;            // metres, from where on the noise grows
constexpr int kRows = kLanes / kBlockSide;  // rows of a block that are worked on at once

/// A block's voxels in the camera's axes: the first one's centre, and the steps to the next along each axis.
struct BlockPlace {
  glm::vec3 first, x, y, z;
};

/// What the image says of kLanes voxels.
struct Sights {
  alignas(64) float z[kLanes];
  alignas(64) float distance[kLanes];
  alignas(64) std::int32_t told[kLanes];
};

/// Whether it says anything of any of them.
ROSEFUSION_INLINE bool look(const NativeFusion& f, const float* depth, float x0, float y0, float z0,
                            const BlockPlace& b, Sights& out) {
  const float fx = f.camera.focal_centre.x, fy = f.camera.focal_centre.y, cx = f.camera.focal_centre.z + 0.5f,
              cy = f.camera.focal_centre.w + 0.5f, truncation = f.truncation;
  const std::int32_t columns = f.camera.size.x;
  const auto width = static_cast<float>(columns), height = static_cast<float>(f.camera.size.y);
  const float ax = b.x.x, ay = b.x.y, az = b.x.z, bx = b.y.x, by = b.y.y, bz = b.y.z;
  std::int32_t any = 0;
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const auto i = static_cast<float>(k % kBlockSide), j = static_cast<float>(k / kBlockSide);
    const float x = x0 + i * ax + j * bx, y = y0 + i * ay + j * by, z = z0 + i * az + j * bz;
    const float inverse = 1 / z;
    const float u = fx * x * inverse + cx, v = fy * y * inverse + cy;
    const bool inside = (z > 0) & (u >= 0) & (v >= 0) & (u < width) & (v < height);
    const float left = u > 0 ? u : 0, above = v > 0 ? v : 0;
    const auto column = static_cast<std::int32_t>(left < width ? left : 0);
    const auto row = static_cast<std::int32_t>(above < height ? above : 0);
    const float seen = depth[row * columns + column] * (inside ? 1.0f : 0.0f);
    const float distance = (seen * inverse - 1) * std::sqrt(x * x + y * y + z * z);
    const std::int32_t told = (seen > 0) & (distance >= -truncation);
    out.z[k] = seen;
    out.distance[k] = distance;
    out.told[k] = told;
    any |= told;
  }
  return any != 0;
}

ROSEFUSION_INLINE void fuse(const NativeFusion& f, float voxel_size, const Sights& sights,
                            std::int16_t* codes, std::uint16_t* units) {
  const float per_truncation = 1 / f.truncation, least_voxels = kVoxels * voxel_size * per_truncation;
  const float floor = f.noise.floor, growth = f.noise.growth, bias_growth = f.noise.bias_growth;
  const float most = f.max_weight;
  const std::int32_t thin = f.thin_walls;
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float tsdf = static_cast<float>(codes[k]) * kTsdfOfCode;
    const float weight = static_cast<float>(units[k]) * (1 / kWeightOne);
    const float z = sights.z[k], along = sights.distance[k] * per_truncation;
    const float value = along < 1 ? along : 1.0f;
    const float beyond = z > kNearest ? z - kNearest : 0.0f;
    const float noise = floor + growth * beyond * beyond, bias = bias_growth * z * z;
    const float share = floor * floor / (noise * noise + bias * bias);
    const float gain = share > 1 / kWeightOne ? share : 1 / kWeightOne;
    const float deviations = kDeviations * noise * per_truncation;
    const float least = deviations > least_voxels ? deviations : least_voxels;
    const float behind_old = -least < tsdf - least ? -least : tsdf - least;
    const float behind_new = -least < value - least ? -least : value - least;
    const std::int32_t contested = thin & (weight > 0);
    const std::int32_t kept = contested & (tsdf < least) & (value < behind_old);
    const float before = (contested & (tsdf < behind_new)) ? 0.0f : weight;
    const float mean = (tsdf * before + value * gain) / (before + gain);
    const float sum = before + gain < most ? before + gain : most;
    const float clamped = mean < -1 ? -1.0f : mean > 1 ? 1.0f : mean;
    const float scaled = clamped * 32767 + (clamped < 0 ? -0.5f : 0.5f);
    const auto code = static_cast<std::int32_t>(scaled),
               unit = static_cast<std::int32_t>(sum * kWeightOne + 0.5f);
    const std::int32_t written = -(sights.told[k] & (kept ^ 1));
    codes[k] = static_cast<std::int16_t>((code & written) | (codes[k] & ~written));
    units[k] = static_cast<std::uint16_t>((unit & written) | (units[k] & ~written));
  }
}

ROSEFUSION_INLINE void integrateBlock(const NativeFusion& f, const float* depth, const BlockPlace& place,
                                      float voxel_size, std::int16_t* codes, std::uint16_t* units) {
  Sights sights;
  for (int z = 0; z < kBlockSide; ++z)
    for (int y = 0; y < kBlockSide; y += kRows) {
      const glm::vec3 first = place.first + static_cast<float>(y) * place.y + static_cast<float>(z) * place.z;
      const int at = (z * kBlockSide + y) * kBlockSide;
      if (look(f, depth, first.x, first.y, first.z, place, sights))
        fuse(f, voxel_size, sights, codes + at, units + at);
    }
}

ROSEFUSION_NATIVE(integrateOne, integrateBlock)

}  // namespace

void nativeIntegrate(NativeVolume& volume, std::span<const std::uint32_t> slots, std::span<const float> depth,
                     const NativeFusion& fusion, int threads) {
  constexpr std::size_t kTogether = 16;  // blocks a thread takes at once
  const glm::mat3 turn(fusion.camera_from_world);
  const glm::mat3 step = turn * volume.voxel_size;
  const glm::vec3 shift(fusion.camera_from_world[3]);
  const auto pieces = static_cast<std::uint32_t>((slots.size() + kTogether - 1) / kTogether);
  inParallel(pieces, threads, [&](std::uint32_t piece) {
    for (std::size_t i = piece * kTogether; i < std::min(slots.size(), (piece + 1) * kTogether); ++i) {
      const std::size_t slot = slots[i];
      const glm::vec3 centre = glm::vec3(volume.blocks[slot]) * static_cast<float>(kBlockSide) + 0.5f;
      const BlockPlace place{step * centre + shift, step[0], step[1], step[2]};
      integrateOne(fusion, depth.data(), place, volume.voxel_size, &volume.codes[slot * kBlockVoxels],
                   &volume.units[slot * kBlockVoxels]);
    }
  });
}

}  // namespace rosefusion
