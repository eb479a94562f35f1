// What the native loops read around positions: a volume's voxels, one lane per position.
#pragma once
#include <cmath>

#include "host/bench/native_loop.h"
#include "host/bench/native_volume.h"

namespace rosefusion {

/// Positions in voxels from the page table's corner, two voxels or more inside of it.
struct LanePositions {
  alignas(64) float x[kLanes];
  alignas(64) float y[kLanes];
  alignas(64) float z[kLanes];
};

/// The trilinear value and the gradient of the quadratic B-spline, per voxel; the largest sizes of the stored
/// values among the 27 voxels around, and among the 8 of the position's cell.
struct LaneNeighbourhoods {
  alignas(64) float value[kLanes];
  alignas(64) float slope_x[kLanes];
  alignas(64) float slope_y[kLanes];
  alignas(64) float slope_z[kLanes];
  alignas(64) float largest[kLanes];
  alignas(64) float largest_in_cell[kLanes];
};

ROSEFUSION_INLINE float valueOf(std::int32_t code) {
  return static_cast<float>(code) * kTsdfOfCode;
}

/// Codes of kSide^3 voxels per lane, x fastest, from (x, y, z) on. Fetched one by one: their addresses have
/// little in common from lane to lane, and a gather is no faster.
template <int kSide>
ROSEFUSION_INLINE void fetchVoxels(const NativeVolume& volume, const std::int32_t* x, const std::int32_t* y,
                                   const std::int32_t* z, std::int16_t (*out)[kLanes]) {
  const std::int32_t row = volume.table_size.x, plane = row * volume.table_size.y;
  const std::int32_t* table = volume.table.data();
  const std::int16_t* codes = volume.codes.data();
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int32_t first = x[lane] >> 3, last = (x[lane] + kSide - 1) >> 3;
    for (int k = 0; k < kSide; ++k)
      for (int j = 0; j < kSide; ++j) {
        const std::int32_t w = z[lane] + k, v = y[lane] + j;
        const std::int32_t* entries = table + (w >> 3) * plane + (v >> 3) * row;
        const std::int32_t a = entries[first], b = entries[last], within = (w & 7) << 6 | (v & 7) << 3;
        for (int i = 0; i < kSide; ++i) {
          const std::int32_t u = x[lane] + i;
          out[(k * kSide + j) * kSide + i][lane] = codes[((u >> 3) == first ? a : b) + within + (u & 7)];
        }
      }
  }
}

ROSEFUSION_INLINE void readNeighbourhoods(const NativeVolume& volume, const LanePositions& at,
                                          LaneNeighbourhoods& out) {
  alignas(64) std::int32_t x[kLanes], y[kLanes], z[kLanes];
  alignas(64) std::int16_t voxel[27][kLanes];
  for (int k = 0; k < kLanes; ++k) {
    x[k] = static_cast<std::int32_t>(at.x[k]) - 1;
    y[k] = static_cast<std::int32_t>(at.y[k]) - 1;
    z[k] = static_cast<std::int32_t>(at.z[k]) - 1;
  }
  fetchVoxels<3>(volume, x, y, z, voxel);
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    // From the middle voxel's centre.
    const float fx = at.x[k] - static_cast<float>(x[k]) - 1.5f,
                fy = at.y[k] - static_cast<float>(y[k]) - 1.5f,
                fz = at.z[k] - static_cast<float>(z[k]) - 1.5f;
    const float lx[3] = {fx < 0 ? -fx : 0, 1 - std::fabs(fx), fx > 0 ? fx : 0};
    const float ly[3] = {fy < 0 ? -fy : 0, 1 - std::fabs(fy), fy > 0 ? fy : 0};
    const float lz[3] = {fz < 0 ? -fz : 0, 1 - std::fabs(fz), fz > 0 ? fz : 0};
    const float sx[3] = {0.5f * (0.5f - fx) * (0.5f - fx), 0.75f - fx * fx, 0.5f * (0.5f + fx) * (0.5f + fx)};
    const float sy[3] = {0.5f * (0.5f - fy) * (0.5f - fy), 0.75f - fy * fy, 0.5f * (0.5f + fy) * (0.5f + fy)};
    const float sz[3] = {0.5f * (0.5f - fz) * (0.5f - fz), 0.75f - fz * fz, 0.5f * (0.5f + fz) * (0.5f + fz)};
    const float dx[3] = {fx - 0.5f, -2 * fx, fx + 0.5f}, dy[3] = {fy - 0.5f, -2 * fy, fy + 0.5f},
                dz[3] = {fz - 0.5f, -2 * fz, fz + 0.5f};
    // 1 where the middle voxel and the one beside it make the cell.
    const float in_y[3] = {fy < 0 ? 1.0f : 0.0f, 1, fy < 0 ? 0.0f : 1.0f};
    const float in_z[3] = {fz < 0 ? 1.0f : 0.0f, 1, fz < 0 ? 0.0f : 1.0f};
    float value = 0, gx = 0, gy = 0, gz = 0, largest = 0, in_cell = 0;
    ROSEFUSION_UNROLL
    for (int c = 0; c < 3; ++c) {
      ROSEFUSION_UNROLL
      for (int b = 0; b < 3; ++b) {
        const float v0 = valueOf(voxel[9 * c + 3 * b][k]), v1 = valueOf(voxel[9 * c + 3 * b + 1][k]),
                    v2 = valueOf(voxel[9 * c + 3 * b + 2][k]);
        value += (lx[0] * v0 + lx[1] * v1 + lx[2] * v2) * (ly[b] * lz[c]);
        const float along = sx[0] * v0 + sx[1] * v1 + sx[2] * v2,
                    sloping = dx[0] * v0 + dx[1] * v1 + dx[2] * v2;
        gx += sloping * (sy[b] * sz[c]);
        gy += along * (dy[b] * sz[c]);
        gz += along * (sy[b] * dz[c]);
        const float s0 = std::fabs(v0), s1 = std::fabs(v1), s2 = std::fabs(v2), side = fx < 0 ? s0 : s2;
        const float ends = s0 > s2 ? s0 : s2, row = ends > s1 ? ends : s1, cell_row = side > s1 ? side : s1;
        largest = row > largest ? row : largest;
        const float counted = cell_row * (in_y[b] * in_z[c]);
        in_cell = counted > in_cell ? counted : in_cell;
      }
    }
    out.value[k] = value;
    out.slope_x[k] = gx;
    out.slope_y[k] = gy;
    out.slope_z[k] = gz;
    out.largest[k] = largest;
    out.largest_in_cell[k] = in_cell;
  }
}

}  // namespace rosefusion
