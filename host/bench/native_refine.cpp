#include "host/bench/native_refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/bench/native_loop.h"
#include "host/bench/native_neighbourhood.h"

namespace rosefusion {
namespace {

using namespace shader;

constexpr float kNearest = 0.4f;     // metres, from where on the noise grows
constexpr float kBackCosine = 0.2f;  // grazing surfaces are noise on either side of 0
constexpr float kCloseDeviations = 2;
constexpr float kTruncated = 0.999f;   // of a stored value: beyond, the voxel tells no distance
constexpr std::size_t kTogether = 32;  // groups of kLanes points that one sum in single precision holds

/// A candidate and what is asked of it.
struct Asked {
  RefineCandidate candidate;
  glm::vec3 shift, last;  ///< of positions, voxels from the table's corner
  float voxels_per_metre, truncation, inside;
  glm::vec2 last_size;
  RefineWeights weights;
};

struct LaneSums {
  alignas(64) float of[kRefineSums][kLanes];
};

/// `number` of the lanes have a point.
ROSEFUSION_INLINE void addPoints(const NativeVolume& volume, const Asked& a, const glm::vec4* points,
                                 int number, LaneSums& sums) {
  LanePositions at;
  LaneNeighbourhoods near;
  alignas(64) float px[kLanes], py[kLanes], pz[kLanes], arm_x[kLanes], arm_y[kLanes], arm_z[kLanes];
  alignas(64) float model_weight[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    const glm::vec4& p = points[k < number ? k : 0];
    px[k] = p.x;
    py[k] = p.y;
    pz[k] = p.z;
  }
  const glm::mat4& m = a.candidate.world_from_camera;
  const float r00 = m[0].x, r10 = m[0].y, r20 = m[0].z, r01 = m[1].x, r11 = m[1].y, r21 = m[1].z,
              r02 = m[2].x, r12 = m[2].y, r22 = m[2].z;
  const float scale = a.voxels_per_metre, tx = a.shift.x, ty = a.shift.y, tz = a.shift.z;
  const float ex = a.last.x, ey = a.last.y, ez = a.last.z;
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float x = r00 * px[k] + r01 * py[k] + r02 * pz[k], y = r10 * px[k] + r11 * py[k] + r12 * pz[k],
                z = r20 * px[k] + r21 * py[k] + r22 * pz[k];
    const float vx = x * scale + tx, vy = y * scale + ty, vz = z * scale + tz;
    const float cx = vx > 2 ? vx : 2, cy = vy > 2 ? vy : 2, cz = vz > 2 ? vz : 2;
    arm_x[k] = x;
    arm_y[k] = y;
    arm_z[k] = z;
    at.x[k] = cx < ex ? cx : ex;
    at.y[k] = cy < ey ? cy : ey;
    at.z[k] = cz < ez ? cz : ez;
  }
  readNeighbourhoods(volume, at, near);
  const std::int32_t row = volume.table_size.x, plane = row * volume.table_size.y;
  for (int k = 0; k < kLanes; ++k) {
    const auto x = static_cast<std::int32_t>(at.x[k]), y = static_cast<std::int32_t>(at.y[k]),
               z = static_cast<std::int32_t>(at.z[k]);
    const std::int32_t voxel =
        volume.table[(z >> 3) * plane + (y >> 3) * row + (x >> 3)] + ((z & 7) << 6 | (y & 7) << 3 | (x & 7));
    model_weight[k] = static_cast<float>(std::max<int>(volume.units[voxel], 1)) * (1 / kWeightOne);
  }
  const glm::mat4& l = a.candidate.last_image_from_camera;
  const float l00 = l[0].x, l10 = l[0].y, l20 = l[0].z, l01 = l[1].x, l11 = l[1].y, l21 = l[1].z,
              l02 = l[2].x, l12 = l[2].y, l22 = l[2].z, l03 = l[3].x, l13 = l[3].y, l23 = l[3].z;
  const float inside = a.inside, width = a.last_size.x - 0.5f, height = a.last_size.y - 0.5f;
  const float huber = a.weights.huber, floor = a.weights.noise.floor, growth = a.weights.noise.growth,
              bias_growth = a.weights.noise.bias_growth, truncation = a.truncation;
  const float model_variance = a.weights.model_noise * a.weights.model_noise,
              most = huber * (truncation - 0.5f * huber);
  const float furthest = truncation <= huber ? 0.5f * truncation * truncation : most;
  const std::int32_t front_only = a.weights.front_only;
  auto& s = sums.of;
  ROSEFUSION_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float beyond = pz[k] > kNearest ? pz[k] - kNearest : 0.0f;
    const float noise = floor + growth * beyond * beyond, bias = bias_growth * pz[k] * pz[k];
    const std::int32_t usable = near.largest_in_cell[k] < kTruncated, sloped = near.largest[k] < kTruncated;
    const float model = model_variance / model_weight[k];
    const float variance = noise * noise + bias * bias + (usable ? model : 0.0f);
    const float cost_weight = 1 / (1 + variance / (huber * huber));
    const float gx = near.slope_x[k], gy = near.slope_y[k], gz = near.slope_z[k];
    const float facing = gx * arm_x[k] + gy * arm_y[k] + gz * arm_z[k];
    const float lengths = std::sqrt((gx * gx + gy * gy + gz * gz) *
                                    (arm_x[k] * arm_x[k] + arm_y[k] * arm_y[k] + arm_z[k] * arm_z[k]));
    const std::int32_t back = front_only & usable & sloped & (facing > kBackCosine * lengths);
    const float hx = l00 * px[k] + l01 * py[k] + l02 * pz[k] + l03,
                hy = l10 * px[k] + l11 * py[k] + l12 * pz[k] + l13,
                hz = l20 * px[k] + l21 * py[k] + l22 * pz[k] + l23;
    const std::int32_t seen = (hz > 0) & (hx >= inside - 0.5f * hz) & (hy >= inside - 0.5f * hz) &
                              (hx < width * hz - inside) & (hy < height * hz - inside);
    const std::int32_t counts = (k < number) & (back ^ 1) & (usable | seen);
    const float residual = near.value[k] * truncation, size = std::fabs(residual);
    const float robust = size <= huber ? 0.5f * size * size : huber * (size - 0.5f * huber);
    const bool read = counts & usable, fits = read & (sloped != 0);
    s[kRefineMostCost][k] += counts ? cost_weight * furthest : 0.0f;
    s[kRefineCost][k] += counts ? cost_weight * (usable ? robust : furthest) : 0.0f;
    s[kRefineCostWeight][k] += read ? cost_weight : 0.0f;
    s[kRefineUsable][k] += read ? 1.0f : 0.0f;
    s[kRefineRows][k] += read ? py[k] / pz[k] : 0.0f;
    const float close = kCloseDeviations * noise > huber ? kCloseDeviations * noise : huber;
    s[kRefineClose][k] += read & (size < close) ? 1.0f : 0.0f;
    const float per_metre = fits ? truncation * scale : 0.0f;
    const float jx = gx * per_metre, jy = gy * per_metre, jz = gz * per_metre;
    const float j[6] = {jx,
                        jy,
                        jz,
                        arm_y[k] * jz - arm_z[k] * jy,
                        arm_z[k] * jx - arm_x[k] * jz,
                        arm_x[k] * jy - arm_y[k] * jx};
    const float weight = floor * floor / variance * (size > huber ? huber / size : 1.0f);
    ROSEFUSION_UNROLL
    for (int i = 0; i < 6; ++i) {
      const float scaled = weight * j[i];
      ROSEFUSION_UNROLL
      for (int c = 0; c < 6; ++c)
        if (c >= i) s[kRefineHessian + i * 6 - i * (i - 1) / 2 + c - i][k] += scaled * j[c];
      s[kRefineGradient + i][k] += scaled * residual;
    }
  }
}

/// `points` of at most kTogether groups.
ROSEFUSION_INLINE void addPart(const NativeVolume& volume, const Asked& asked,
                               std::span<const glm::vec4> points, RefineSums& sums) {
  LaneSums lanes{};
  for (std::size_t i = 0; i < points.size(); i += kLanes)
    addPoints(volume, asked, &points[i], static_cast<int>(std::min<std::size_t>(points.size() - i, kLanes)),
              lanes);
  for (std::size_t k = 0; k < sums.size(); ++k)
    for (const float lane : lanes.of[k]) sums[k] += lane;
}

ROSEFUSION_NATIVE(addOne, addPart)

}  // namespace

std::vector<RefineSums> nativeRefine(const NativeVolume& volume, float truncation,
                                     std::span<const glm::vec4> points,
                                     std::span<const RefineCandidate> candidates,
                                     const CameraIntrinsics& last_camera, const RefineWeights& weights,
                                     int threads) {
  constexpr std::size_t kPart = kTogether * kLanes;
  const std::size_t parts = (points.size() + kPart - 1) / kPart;
  std::vector<RefineSums> of_parts(candidates.size() * parts, RefineSums{}),
      out(candidates.size(), RefineSums{});
  const float scale = 1 / volume.voxel_size;
  inParallel(static_cast<std::uint32_t>(of_parts.size()), threads, [&](std::uint32_t i) {
    const RefineCandidate& candidate = candidates[i / parts];
    const Asked asked{
        candidate,
        glm::vec3(candidate.world_from_camera[3]) * scale - glm::vec3(volume.table_origin * kBlockSide),
        glm::vec3(volume.table_size * kBlockSide) - 3.0f,
        scale,
        truncation,
        std::max(last_camera.focal_centre.x, last_camera.focal_centre.y) * std::numbers::sqrt3_v<float> *
            volume.voxel_size,
        glm::vec2(last_camera.size.x, last_camera.size.y),
        weights};
    const std::size_t first = i % parts * kPart;
    addOne(volume, asked, points.subspan(first, std::min(kPart, points.size() - first)), of_parts[i]);
  });
  for (std::size_t i = 0; i < of_parts.size(); ++i)
    for (std::size_t k = 0; k < kRefineSums; ++k) out[i / parts][k] += of_parts[i][k];
  return out;
}

}  // namespace rosefusion
