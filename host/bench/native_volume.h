// A downloaded volume as the native loops read it.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/volume.h"

namespace rosefusion {

/// Paged as on the device: blocks of 8^3 voxels, x fastest, behind a dense page table.
struct NativeVolume {
  /// `contents` as Volume::download gives them.
  NativeVolume(const VolumeContents& contents, float voxel_size);

  float voxel_size = 0;
  glm::ivec3 table_origin{0};  ///< block coordinate of the first entry; a border of absent entries included
  glm::ivec3 table_size{0};
  std::vector<glm::ivec4> blocks;  ///< block coordinate per slot; slot 0 is the unobserved block
  std::vector<std::int32_t>
      table;  ///< first voxel of the entry's block; 0, the unobserved block, where absent
  std::vector<std::int32_t> tsdf;    ///< two voxels a word, the first in the low half, for gathers
  std::vector<std::int16_t> codes;   ///< the same voxel by voxel; 32767 = one truncation
  std::vector<std::uint16_t> units;  ///< weights in units of 1 / kWeightOne
};

/// Of a voxel's code, one truncation being 1.
inline constexpr float kTsdfOfCode = 1.0f / 32767.0f;

}  // namespace rosefusion
