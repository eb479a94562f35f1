// The fitness pass as a tuned multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/passes/fitness.h"

namespace rosefusion {

/// A downloaded volume, paged as on the device: blocks of 8^3 voxels of 16 bits behind a dense page table.
struct NativeVolume {
  /// `contents` as Volume::download gives them.
  NativeVolume(const VolumeContents& contents, float voxel_size);

  float voxel_size = 0;
  glm::ivec3 table_origin{0};  ///< block coordinate of the first entry; a border of absent entries included
  glm::ivec3 table_size{0};
  std::vector<std::int32_t>
      table;  ///< first voxel of the entry's block; 0, the unobserved block, where absent
  std::vector<std::int32_t> tsdf;  ///< two voxels a word, the first in the low half; 32767 = one truncation
};

/// Particles in vector lanes, Kahan-compensated, nearest voxel, spread over `threads` threads. `templates` as
/// in FitnessPass; `points`: camera frame, metres. Mean loss per particle; -1 without points.
std::vector<float> nativeLosses(const NativeVolume& volume, std::span<const glm::vec4> templates,
                                std::span<const glm::vec4> points, const SwarmPlacement& swarm, Loss loss,
                                int threads);

/// The instruction set that nativeLosses uses on this machine, in words.
std::string nativeInstructionSet();

}  // namespace rosefusion
