#include "host/bench/native_fitness.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "host/bench/native_loop.h"

namespace rosefusion {
namespace {

using shader::kBlockSide;

/// The poses of kLanes particles, from metres in the camera to voxels from the page table's corner.
struct LanePoses {
  alignas(64) float rotation[9][kLanes];  // column by column
  alignas(64) float translation[3][kLanes];
};

LanePoses posesOf(const NativeVolume& volume, std::span<const glm::vec4> templates,
                  const SwarmPlacement& swarm, std::uint32_t first) {
  LanePoses out;
  const float scale = 1 / volume.voxel_size;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::size_t entry = 2 * (swarm.first_particle + std::min(first + lane, swarm.particles - 1));
    const glm::vec3 imaginary = glm::vec3(templates[entry + 1]) * glm::vec3(swarm.rotation_lengths);
    const float square = glm::dot(imaginary, imaginary);
    const glm::vec3 v = square > 1 ? imaginary / std::sqrt(square) : imaginary;
    const glm::quat turn(std::sqrt(std::max(0.0f, 1 - square)), v.x, v.y, v.z);
    const glm::mat3 rotation = glm::mat3_cast(turn) * glm::mat3(swarm.world_from_camera) * scale;
    const glm::vec3 shift = glm::vec3(templates[entry]) * glm::vec3(swarm.translation_lengths);
    const glm::vec3 translation =
        (glm::vec3(swarm.world_from_camera[3]) + shift) * scale - glm::vec3(volume.table_origin * kBlockSide);
    for (int i = 0; i < 9; ++i) out.rotation[i][lane] = rotation[i / 3][i % 3];
    for (int i = 0; i < 3; ++i) out.translation[i][lane] = translation[i];
  }
  return out;
}

template <bool kSquared>
ROSEFUSION_INLINE void sumLosses(const NativeVolume& volume, const LanePoses& poses,
                                 std::span<const glm::vec4> points, float* losses) {
  const std::int32_t* table = volume.table.data();
  const std::int32_t* tsdf = volume.tsdf.data();
  const std::int32_t row = volume.table_size.x, plane = row * volume.table_size.y;
  const glm::vec3 end = glm::vec3(volume.table_size * kBlockSide) - 0.5f;
  const float end_x = end.x, end_y = end.y, end_z = end.z;
  const auto& r = poses.rotation;
  const auto& t = poses.translation;
  alignas(64) float sum[kLanes] = {}, lost[kLanes] = {};
  for (const glm::vec4& p : points) {
    const float px = p.x, py = p.y, pz = p.z;
    ROSEFUSION_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float x = r[0][k] * px + r[3][k] * py + r[6][k] * pz + t[0][k];
      const float y = r[1][k] * px + r[4][k] * py + r[7][k] * pz + t[1][k];
      const float z = r[2][k] * px + r[5][k] * py + r[8][k] * pz + t[2][k];
      const float cx = x > 0 ? x : 0, cy = y > 0 ? y : 0, cz = z > 0 ? z : 0;
      const auto vx = static_cast<std::int32_t>(cx < end_x ? cx : end_x);
      const auto vy = static_cast<std::int32_t>(cy < end_y ? cy : end_y);
      const auto vz = static_cast<std::int32_t>(cz < end_z ? cz : end_z);
      const std::int32_t voxel = table[(vz >> 3) * plane + (vy >> 3) * row + (vx >> 3)] +
                                 (((vz & 7) << 6) | ((vy & 7) << 3) | (vx & 7));
      const std::int32_t word = tsdf[voxel >> 1];
      const std::int32_t value =
          ((voxel & 1) ? word : static_cast<std::int32_t>(std::uint32_t(word) << 16)) >> 16;
      const float psi = static_cast<float>(value) * (1.0f / 32767.0f);
      const float term = (kSquared ? psi * psi : std::fabs(psi)) - lost[k];
      const float total = sum[k] + term;
      lost[k] = (total - sum[k]) - term;
      sum[k] = total;
    }
  }
  for (int k = 0; k < kLanes; ++k) losses[k] = sum[k] / static_cast<float>(points.size());
}

ROSEFUSION_NATIVE(sumSquares, sumLosses<true>)
ROSEFUSION_NATIVE(sumSizes, sumLosses<false>)

}  // namespace

std::vector<float> nativeLosses(const NativeVolume& volume, std::span<const glm::vec4> templates,
                                std::span<const glm::vec4> points, const SwarmPlacement& swarm, Loss loss,
                                int threads) {
  if (points.empty()) return std::vector<float>(swarm.particles, -1.0f);
  const std::uint32_t groups = (swarm.particles + kLanes - 1) / kLanes;
  std::vector<float> losses(std::size_t(groups) * kLanes);
  inParallel(groups, threads, [&](std::uint32_t group) {
    const LanePoses poses = posesOf(volume, templates, swarm, group * kLanes);
    float* at = &losses[std::size_t(group) * kLanes];
    loss == Loss::Squared ? sumSquares(volume, poses, points, at) : sumSizes(volume, poses, points, at);
  });
  losses.resize(swarm.particles);
  return losses;
}

}  // namespace rosefusion
