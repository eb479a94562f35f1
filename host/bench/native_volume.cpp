#include "host/bench/native_volume.h"

#include <cmath>
#include <glm/common.hpp>

namespace rosefusion {

using shader::kBlockVoxels;

NativeVolume::NativeVolume(const VolumeContents& contents, float voxel_size_)
    : voxel_size(voxel_size_), blocks(contents.blocks) {
  glm::ivec3 low(0), high(0);
  for (std::size_t slot = 1; slot < blocks.size(); ++slot) {
    const glm::ivec3 block(blocks[slot]);
    low = slot == 1 ? block : glm::min(low, block);
    high = slot == 1 ? block : glm::max(high, block);
  }
  table_origin = low - 1;
  table_size = high - low + 3;
  table.assign(std::size_t(table_size.x) * table_size.y * table_size.z, 0);
  for (std::size_t slot = 1; slot < blocks.size(); ++slot) {
    const glm::ivec3 entry = glm::ivec3(blocks[slot]) - table_origin;
    table[(std::size_t(entry.z) * table_size.y + entry.y) * table_size.x + entry.x] =
        static_cast<std::int32_t>(slot * kBlockVoxels);
  }
  for (const float value : contents.tsdf)
    codes.push_back(static_cast<std::int16_t>(std::lround(value * 32767)));
  for (const float weight : contents.weight)
    units.push_back(static_cast<std::uint16_t>(std::lround(weight * shader::kWeightOne)));
  tsdf.resize(codes.size() / 2);
  for (std::size_t word = 0; word < tsdf.size(); ++word)
    tsdf[word] =
        static_cast<std::int32_t>(static_cast<std::uint16_t>(codes[2 * word]) |
                                  std::uint32_t(static_cast<std::uint16_t>(codes[2 * word + 1])) << 16);
}

}  // namespace rosefusion
