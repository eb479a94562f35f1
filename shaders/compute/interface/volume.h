// The voxel-block volume as shaders see it.
// Blocks of 8^3 voxels live in pools of up to kMaxPoolChunks buffers and are found through a dense page table
// over the bounding box of what was seen. Slot 0 is a block that stays unobserved: absent space reads from
// it, so a lookup has no branch. The table has a border of absent entries, so coordinates are clamped instead
// of tested. A voxel is a 16-bit signed normalised TSDF value (truncation = 1; unobserved = +1), a 16-bit
// weight in units of 1/kWeightOne and, optionally, a colour (8-bit RGB; the top byte is its own weight).
// Within a block the voxels lie by cubes of 2^3, x fastest, then y, and within a cube so again: the 8 voxels
// of a cube are then one vector of four words, and what lies around any position is 8 such vectors.
#ifndef ROSEFUSION_INTERFACE_VOLUME_H
#define ROSEFUSION_INTERFACE_VOLUME_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const int kBlockSide = 8;
const uint kBlockVoxels = 512u;
const uint kBlockTsdfWords = 256u;  // 32-bit words of a block in the TSDF pool; the weight pool has as many
const uint kBlockColourWords = 512u;
const uint kMaxPoolChunks = 4u;
const uint kRequested = 0xFFFFFFFFu;  // page-table mark: wanted, no slot yet
const float kWeightOne = 256.0;
const uint kUnobservedTsdf = 0x7FFF7FFFu;  // two voxels at +1

struct VolumeLayout {
  ivec4 table_origin;  // block coordinate of entry (0, 0, 0), the border included; w: log2 of blocks per pool
                       // chunk
  ivec4 table_size;    // entries per axis, the border included; w: unused
  vec4 scale;          // voxel size, 1 / voxel size, truncation, largest weight
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
