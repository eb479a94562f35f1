#include "host/bench/native_raycast.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bench/native_loop.h"
#include "host/bench/native_neighbourhood.h"
#include "host/bench/native_raycast_range.h"

namespace rosefusion {
namespace {

using shader::kBlockSide;
using shader::kBlockVoxels;

constexpr int kTile = shader::kRaycastTile;
constexpr int kSide = 4;  // pixels of a packet along x and y
static_assert(kSide * kSide == kLanes && kTile % kSide == 0);

// In voxels but for the shares; what they are for: shaders/compute/raycast.comp.
constexpr float kStepShare = 0.8f, kLongestStep = 3, kPastExit = 0.01f, kPastShare = 1e-6f,
                kBeforeExit = 0.5f;
constexpr float kLeastSlope = -1e-3f, kConverged = 0.2f, kMaxResidual = 0.5f;
constexpr int kMaxCandidates = 8, kMaxSteps = 5;

/// What is the same for all rays of a view.
struct Scene {
  const NativeVolume& volume;
  const NativeRanges& ranges;
  shader::CameraIntrinsics camera;
  glm::mat3 turn;
  glm::vec3 origin;  ///< voxels from the table's corner
  float band;        ///< the truncation in voxels
};

constexpr std::int32_t kWalks = 0, kFound = 1, kHit = 2, kMissed = 3;

/// Rays in voxels from the table's corner; `t` counts voxels.
struct Rays {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes];     ///< directions, of unit length
  alignas(64) float ix[kLanes], iy[kLanes], iz[kLanes];  ///< their inverse
  alignas(64) float per_depth[kLanes];                   ///< voxels along the ray per metre of depth
  alignas(64) float t[kLanes], end[kLanes];
  alignas(64) float value[kLanes];         ///< of the sample behind a surface
  alignas(64) float front_t[kLanes];       ///< of the sample before
  alignas(64) std::int32_t front[kLanes];  ///< whether that one was in front
  alignas(64) std::int32_t state[kLanes];
  alignas(64) float slope_x[kLanes], slope_y[kLanes], slope_z[kLanes];  ///< at the surface
};

ROSEFUSION_INLINE void startRays(const Scene& s, int left, int top, Rays& r) {
  const glm::vec4 k = s.camera.focal_centre;
  const float scale = 1 / s.volume.voxel_size, side = static_cast<float>(kBlockSide);
  const glm::vec2 tile = s.ranges.tiles[std::size_t(top / kTile) * s.ranges.columns + left / kTile];
  const float low[3] = {side - s.origin.x, side - s.origin.y, side - s.origin.z};
  const float high[3] = {side * static_cast<float>(s.volume.table_size.x - 1) - s.origin.x,
                         side * static_cast<float>(s.volume.table_size.y - 1) - s.origin.y,
                         side * static_cast<float>(s.volume.table_size.z - 1) - s.origin.z};
  const glm::mat3 m = s.turn;
  ROSEFUSION_LANES
  for (int lane = 0; lane < kLanes; ++lane) {
    const float a = (static_cast<float>(left + lane % kSide) - k.z) / k.x,
                b = (static_cast<float>(top + lane / kSide) - k.w) / k.y;
    const float length = std::sqrt(a * a + b * b + 1), share = 1 / length;
    const float d[3] = {(m[0].x * a + m[1].x * b + m[2].x) * share,
                        (m[0].y * a + m[1].y * b + m[2].y) * share,
                        (m[0].z * a + m[1].z * b + m[2].z) * share};
    float inverse[3], enter = -1e30f, leave = 1e30f;
    ROSEFUSION_UNROLL
    for (int i = 0; i < 3; ++i) {
      inverse[i] = 1 / (std::fabs(d[i]) < 1e-9f ? 1e-9f : d[i]);
      const float one = low[i] * inverse[i], other = high[i] * inverse[i];
      const float first = one < other ? one : other, second = one < other ? other : one;
      enter = first > enter ? first : enter;
      leave = second < leave ? second : leave;
    }
    r.x[lane] = d[0];
    r.y[lane] = d[1];
    r.z[lane] = d[2];
    r.ix[lane] = inverse[0];
    r.iy[lane] = inverse[1];
    r.iz[lane] = inverse[2];
    const float per_depth = length * scale, nearest = tile.x * per_depth, farthest = tile.y * per_depth;
    r.per_depth[lane] = per_depth;
    r.t[lane] = r.front_t[lane] = enter > nearest ? enter : nearest;
    r.end[lane] = leave < farthest ? leave : farthest;
    r.value[lane] = 1;
    r.front[lane] = 0;
    r.state[lane] = kWalks;
    r.slope_x[lane] = r.slope_y[lane] = r.slope_z[lane] = 0;
  }
}

/// The nearest voxel's place in a block, and the entry of that block.
ROSEFUSION_INLINE std::int32_t clampedTo(std::int32_t value, std::int32_t end) {
  const std::int32_t low = value > 0 ? value : 0;
  return low < end ? low : end;
}

/// Every ray that walks goes on to its first sample behind a surface, or to its end.
ROSEFUSION_INLINE void walk(const Scene& s, Rays& r) {
  const std::int32_t* solid = s.ranges.solid.data();
  const std::int32_t* words = s.volume.tsdf.data();
  const std::int32_t row = s.volume.table_size.x, plane = row * s.volume.table_size.y;
  const std::int32_t mx = s.volume.table_size.x - 1, my = s.volume.table_size.y - 1,
                     mz = s.volume.table_size.z - 1;
  const float ox = s.origin.x, oy = s.origin.y, oz = s.origin.z, stride = s.band * kStepShare;
  std::int32_t any;
  do {
    any = 0;
    ROSEFUSION_LANES
    for (int k = 0; k < kLanes; ++k) {
      const std::int32_t walks = r.state[k] == kWalks;
      const float t = r.t[k];
      const auto vx = static_cast<std::int32_t>(ox + t * r.x[k]),
                 vy = static_cast<std::int32_t>(oy + t * r.y[k]),
                 vz = static_cast<std::int32_t>(oz + t * r.z[k]);
      const std::int32_t ex = vx >> 3, ey = vy >> 3, ez = vz >> 3;
      const std::int32_t here =
          solid[clampedTo(ez, mz) * plane + clampedTo(ey, my) * row + clampedTo(ex, mx)];
      const std::int32_t voxel = here + ((vz & 7) << 6 | (vy & 7) << 3 | (vx & 7));
      const std::int32_t word = words[voxel >> 1];
      const std::int32_t code =
          ((voxel & 1) ? word : static_cast<std::int32_t>(static_cast<std::uint32_t>(word) << 16)) >> 16;
      const float value = static_cast<float>(code) * kTsdfOfCode;
      const float fx = static_cast<float>((ex << 3) + (r.ix[k] > 0 ? kBlockSide : 0)) - ox,
                  fy = static_cast<float>((ey << 3) + (r.iy[k] > 0 ? kBlockSide : 0)) - oy,
                  fz = static_cast<float>((ez << 3) + (r.iz[k] > 0 ? kBlockSide : 0)) - oz;
      const float lx = fx * r.ix[k], ly = fy * r.iy[k], lz = fz * r.iz[k];
      const float lxy = lx < ly ? lx : ly, leave = lxy < lz ? lxy : lz;
      const float past = kPastShare * t > kPastExit ? kPastShare * t : kPastExit;
      const float behind_block = (leave > t ? leave : t) + past;
      const float wanted = std::fabs(value) * stride, longer = wanted > 1 ? wanted : 1.0f;
      const float next = t + (longer < kLongestStep ? longer : kLongestStep);
      const std::int32_t full = here != 0, found = walks & full & (value < 0) & r.front[k];
      const std::int32_t moves = walks & (t < r.end[k]) & (found ^ 1);
      const float moved = full ? next : behind_block;
      r.value[k] = found ? value : r.value[k];
      r.front[k] = moves ? (full ? static_cast<std::int32_t>(value >= 0) : 1) : r.front[k];
      r.front_t[k] = moves ? (full ? t : leave - kBeforeExit) : r.front_t[k];
      r.t[k] = moves ? moved : t;
      const std::int32_t goes_on = moves & (moved < r.end[k]);
      r.state[k] = walks ? (found ? kFound : (goes_on ? kWalks : kMissed)) : r.state[k];
      any |= goes_on;
    }
  } while (any);
}

/// The trilinear value and gradient at guess[k] on each ray, kept inside the table.
struct LaneFields {
  alignas(64) float value[kLanes], slope[kLanes];  ///< the slope: along the ray, per voxel
};

ROSEFUSION_INLINE void placesOn(const Scene& s, const Rays& r, const float* t, LanePositions& out) {
  const float ox = s.origin.x, oy = s.origin.y, oz = s.origin.z;
  const float ex = static_cast<float>(s.volume.table_size.x * kBlockSide - 3),
              ey = static_cast<float>(s.volume.table_size.y * kBlockSide - 3),
              ez = static_cast<float>(s.volume.table_size.z * kBlockSide - 3);
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float x = ox + t[k] * r.x[k], y = oy + t[k] * r.y[k], z = oz + t[k] * r.z[k];
    const float lx = x > 2 ? x : 2, ly = y > 2 ? y : 2, lz = z > 2 ? z : 2;
    out.x[k] = lx < ex ? lx : ex;
    out.y[k] = ly < ey ? ly : ey;
    out.z[k] = lz < ez ? lz : ez;
  }
}

ROSEFUSION_INLINE void readFields(const Scene& s, const Rays& r, const LanePositions& at, LaneFields& out) {
  alignas(64) std::int32_t x[kLanes], y[kLanes], z[kLanes];
  alignas(64) std::int16_t codes[8][kLanes];
  for (int k = 0; k < kLanes; ++k) {
    x[k] = static_cast<std::int32_t>(at.x[k] - 0.5f);
    y[k] = static_cast<std::int32_t>(at.y[k] - 0.5f);
    z[k] = static_cast<std::int32_t>(at.z[k] - 0.5f);
  }
  fetchVoxels<2>(s.volume, x, y, z, codes);
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float fx = at.x[k] - 0.5f - static_cast<float>(x[k]),
                fy = at.y[k] - 0.5f - static_cast<float>(y[k]),
                fz = at.z[k] - 0.5f - static_cast<float>(z[k]);
    const float c0 = valueOf(codes[0][k]), c1 = valueOf(codes[1][k]), c2 = valueOf(codes[2][k]),
                c3 = valueOf(codes[3][k]), c4 = valueOf(codes[4][k]), c5 = valueOf(codes[5][k]),
                c6 = valueOf(codes[6][k]), c7 = valueOf(codes[7][k]);
    const float d0 = c1 - c0, d1 = c3 - c2, d2 = c5 - c4, d3 = c7 - c6;
    const float v0 = c0 + fx * d0, v1 = c2 + fx * d1, v2 = c4 + fx * d2, v3 = c6 + fx * d3;
    const float bottom = v0 + fy * (v1 - v0), top = v2 + fy * (v3 - v2);
    const float dl = d0 + fy * (d1 - d0), dh = d2 + fy * (d3 - d2);
    out.value[k] = bottom + fz * (top - bottom);
    out.slope[k] = r.x[k] * (dl + fz * (dh - dl)) + r.y[k] * ((v1 - v0) + fz * ((v3 - v2) - (v1 - v0))) +
                   r.z[k] * (top - bottom);
  }
}

ROSEFUSION_INLINE std::int32_t voxelAt(const NativeVolume& v, int x, int y, int z) {
  return v.table[(std::size_t(z >> 3) * v.table_size.y + (y >> 3)) * v.table_size.x + (x >> 3)] +
         ((z & 7) << 6 | (y & 7) << 3 | (x & 7));
}

/// Whether all 8 voxels around a position were observed.
ROSEFUSION_INLINE bool wellObserved(const NativeVolume& v, float x, float y, float z) {
  const int a = static_cast<int>(x - 0.5f), b = static_cast<int>(y - 0.5f), c = static_cast<int>(z - 0.5f);
  bool observed = true;
  for (int i = 0; i < 8; ++i)
    observed = observed && v.units[voxelAt(v, a + (i & 1), b + (i >> 1 & 1), c + (i >> 2))] > 0;
  return observed;
}

/// Rays that found a sample behind a surface hit the surface before it, or walk on where there is none.
ROSEFUSION_INLINE void hitSurfaces(const Scene& s, Rays& r) {
  LanePositions at;
  alignas(64) float front_t[kLanes], guess[kLanes], ahead[kLanes], behind[kLanes];
  alignas(64) std::int32_t observed[kLanes], busy[kLanes];
  for (int k = 0; k < kLanes; ++k)
    front_t[k] = r.front_t[k] > r.t[k] - kLongestStep ? r.front_t[k] : r.t[k] - kLongestStep;
  placesOn(s, r, front_t, at);
  for (int k = 0; k < kLanes; ++k) {
    const std::int32_t voxel =
        voxelAt(s.volume, static_cast<int>(at.x[k]), static_cast<int>(at.y[k]), static_cast<int>(at.z[k]));
    const float before = static_cast<float>(s.volume.codes[voxel]) * kTsdfOfCode;
    observed[k] = (before < 1) | (s.volume.units[voxel] > 0);
    ahead[k] = front_t[k] - 1;
    behind[k] = r.t[k] + 1;
    const float share = before > 0 ? before / (before - r.value[k]) : 0.5f;
    guess[k] = front_t[k] + share * (r.t[k] - front_t[k]);
    busy[k] = r.state[k] == kFound;
  }
  std::int32_t any = 1;
  for (int step = 0; any && step < kMaxSteps; ++step) {
    LaneFields field;
    placesOn(s, r, guess, at);
    readFields(s, r, at, field);
    any = 0;
    ROSEFUSION_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float value = field.value[k], slope = field.slope[k] < kLeastSlope ? field.slope[k] : kLeastSlope;
      const float a = value > 0 ? guess[k] : ahead[k], b = value > 0 ? behind[k] : guess[k];
      const float next = guess[k] - value / slope;
      const float kept = (next >= a) & (next <= b) ? next : 0.5f * (a + b);
      const std::int32_t more = busy[k] & !(std::fabs(value) * s.band < kConverged);
      ahead[k] = busy[k] ? a : ahead[k];
      behind[k] = busy[k] ? b : behind[k];
      guess[k] = busy[k] ? kept : guess[k];
      busy[k] = more;
      any |= more;
    }
  }
  LaneNeighbourhoods near;
  placesOn(s, r, guess, at);
  readNeighbourhoods(s.volume, at, near);
  for (int k = 0; k < kLanes; ++k) {
    if (r.state[k] != kFound) continue;
    const float along = near.slope_x[k] * r.x[k] + near.slope_y[k] * r.y[k] + near.slope_z[k] * r.z[k];
    const float correction = std::clamp(near.value[k] / std::min(along, kLeastSlope), -0.5f, 0.5f);
    const bool seen =
        observed[k] && (near.largest_in_cell[k] < 1 || wellObserved(s.volume, at.x[k], at.y[k], at.z[k]));
    if (seen && std::fabs(near.value[k]) * s.band < kMaxResidual) {
      r.state[k] = kHit;
      r.t[k] = guess[k] - correction;
      r.slope_x[k] = near.slope_x[k];
      r.slope_y[k] = near.slope_y[k];
      r.slope_z[k] = near.slope_z[k];
    } else {
      r.front[k] = seen;
      r.t[k] += 1;
      r.state[k] = r.t[k] < r.end[k] ? kWalks : kMissed;
    }
  }
}

ROSEFUSION_INLINE std::int32_t unorm8(float value) {
  const float low = value > 0 ? value : 0;
  return static_cast<std::int32_t>((low < 1 ? low : 1) * 255 + 0.5f);
}
ROSEFUSION_INLINE std::int32_t snorm16(float value) {
  const float low = value > -1 ? value : -1, scaled = (low < 1 ? low : 1) * 32767;
  return static_cast<std::int32_t>(scaled + (scaled < 0 ? -0.5f : 0.5f));
}

/// Shaded by a light at the camera; what was not hit shows the backdrop.
ROSEFUSION_INLINE void shade(const Scene& s, const Rays& r, int top, std::uint32_t* normals, float* depth,
                             std::uint32_t* picture) {
  const auto height = static_cast<float>(s.camera.size.y);
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const bool hit = r.state[k] == kHit;
    const float gx = r.slope_x[k], gy = r.slope_y[k], gz = r.slope_z[k];
    const float square = gx * gx + gy * gy + gz * gz, share = hit ? 1 / std::sqrt(square) : 0.0f;
    const float x = gx * share, y = gy * share, z = gz * share;
    const float sum = std::fabs(x) + std::fabs(y) + std::fabs(z), inverse = 1 / (sum > 1e-20f ? sum : 1e-20f);
    const float a = x * inverse, b = y * inverse;
    const float u = z < 0 ? (1 - std::fabs(b)) * (a >= 0 ? 1.0f : -1.0f) : a,
                v = z < 0 ? (1 - std::fabs(a)) * (b >= 0 ? 1.0f : -1.0f) : b;
    normals[k] = static_cast<std::uint32_t>((snorm16(u) & 0xFFFF) | snorm16(v) << 16);
    depth[k] = hit ? r.t[k] / r.per_depth[k] : 0.0f;
    const float facing = -(x * r.x[k] + y * r.y[k] + z * r.z[k]), f = facing > 0 ? facing : 0;
    const float f2 = f * f, f4 = f2 * f2, f8 = f4 * f4, light = 0.2f + 0.7f * f,
                highlight = 0.1f * (f8 * f8 * f8);
    const float down = static_cast<float>(top + k / kSide) / height;
    const std::int32_t red = unorm8(hit ? 0.80f * light + highlight : 0.16f + down * (0.07f - 0.16f)),
                       green = unorm8(hit ? 0.78f * light + highlight : 0.18f + down * (0.08f - 0.18f)),
                       blue = unorm8(hit ? 0.74f * light + highlight : 0.21f + down * (0.09f - 0.21f));
    picture[k] = static_cast<std::uint32_t>(red | green << 8 | blue << 16) | 0xFF000000u;
  }
}

/// kSide rows of the image from row `top` on.
ROSEFUSION_INLINE void castRows(const Scene& s, int top, NativeView& out) {
  const int width = s.camera.size.x, height = s.camera.size.y;
  Rays rays;
  alignas(64) std::uint32_t normals[kLanes], picture[kLanes];
  alignas(64) float depth[kLanes];
  for (int left = 0; left < width; left += kSide) {
    startRays(s, left, top, rays);
    bool found = true;
    for (int candidate = 0; found && candidate < kMaxCandidates; ++candidate) {
      walk(s, rays);
      found =
          std::any_of(rays.state, rays.state + kLanes, [](std::int32_t state) { return state == kFound; });
      if (found) hitSurfaces(s, rays);
    }
    shade(s, rays, top, normals, depth, picture);
    for (int k = 0; k < kLanes; ++k) {
      const int x = left + k % kSide, y = top + k / kSide;
      if (x >= width || y >= height) continue;
      const std::size_t pixel = std::size_t(y) * width + x;
      out.normals[pixel] = normals[k];
      out.depth[pixel] = depth[k];
      out.picture[pixel] = picture[k];
    }
  }
}

ROSEFUSION_NATIVE(castSome, castRows)

}  // namespace

void nativeRaycast(const NativeVolume& volume, float truncation, const shader::CameraIntrinsics& camera,
                   const RaycastView& view, NativeView& out, int threads) {
  const std::size_t pixels = std::size_t(camera.size.x) * camera.size.y;
  out.normals.resize(pixels);
  out.depth.resize(pixels);
  out.picture.resize(pixels);
  const NativeRanges ranges = nativeRanges(volume, camera, view, threads);
  const float scale = 1 / volume.voxel_size;
  const Scene scene{
      volume,
      ranges,
      camera,
      glm::mat3(view.world_from_camera),
      glm::vec3(view.world_from_camera[3]) * scale - glm::vec3(volume.table_origin * kBlockSide),
      truncation * scale};
  inParallel(static_cast<std::uint32_t>((camera.size.y + kSide - 1) / kSide), threads,
             [&](std::uint32_t rows) { castSome(scene, static_cast<int>(rows) * kSide, out); });
}

}  // namespace rosefusion
