// Addressing of the voxel-block volume (see interface/volume.h). The includer defines the bindings it has:
// VOLUME_LAYOUT (a storage buffer) or VOLUME_UNIFORM_LAYOUT (a uniform one), and optionally VOLUME_TABLE, VOLUME_TSDF,
// VOLUME_WEIGHT and VOLUME_COLOUR (first of four each), to read them: storage buffers, or with READ_TEXELS texel buffers.
#include "shaders/compute/interface/volume.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(constant_id = 0) const uint kPoolChunks = 1u;  // pool buffers in use; the rest repeat the first

#ifdef VOLUME_UNIFORM_LAYOUT
UNIFORM_PARAMETERS(VolumeLayout, volume, VOLUME_UNIFORM_LAYOUT)
#else
layout(std430, binding = VOLUME_LAYOUT) readonly restrict buffer LayoutBuffer { VolumeLayout volume; };
#endif

// The words of the pools NAME_0 to NAME_3 behind one function.
#define POOL_WORD(NAME)                                            \
  uint NAME##Word(uint chunk, uint word) {                         \
    if (kPoolChunks == 1u || chunk == 0u) return NAME##_0(word);   \
    if (kPoolChunks == 2u || chunk == 1u) return NAME##_1(word);   \
    if (kPoolChunks == 3u || chunk == 2u) return NAME##_2(word);   \
    return NAME##_3(word);                                         \
  }
// Four pools that are only read, on the bindings from FIRST on.
#define POOL(NAME, FIRST)          \
  READ_WORDS(NAME##_0, FIRST)      \
  READ_WORDS(NAME##_1, FIRST + 1u) \
  READ_WORDS(NAME##_2, FIRST + 2u) \
  READ_WORDS(NAME##_3, FIRST + 3u) \
  POOL_WORD(NAME)

// Block coordinates by slot.
#define BLOCKS(BINDING)         \
  READ_WORDS(blockWord, BINDING) \
  ivec3 blockAt(uint slot) { return ivec3(blockWord(4u * slot), blockWord(4u * slot + 1u), blockWord(4u * slot + 2u)); }

uint chunkOf(uint slot) { return kPoolChunks == 1u ? 0u : slot >> uint(volume.table_origin.w); }
uint slotInChunk(uint slot) { return kPoolChunks == 1u ? slot : slot & ((1u << uint(volume.table_origin.w)) - 1u); }

float tsdfOf(uint bits16_high) { return max(float(int(bits16_high) >> 16) * (1.0 / 32767.0), -1.0); }

#ifdef VOLUME_TABLE
READ_WORDS(pageTable, VOLUME_TABLE)
uint tableEntry(int entry) { return pageTable(uint(entry)); }

// Slot of the block at table coordinate `entry`, which must lie inside the table; 0 when absent.
uint slotAt(ivec3 entry) {
  return tableEntry((entry.z * volume.table_size.y + entry.y) * volume.table_size.x + entry.x);
}
ivec3 clampToTable(ivec3 entry) { return clamp(entry, ivec3(0), volume.table_size.xyz - 1); }
#endif

#ifdef VOLUME_TSDF
POOL(tsdf, VOLUME_TSDF)

uint tsdfWordInBlock(uint slot, uint word) { return tsdfWord(chunkOf(slot), slotInChunk(slot) * kBlockTsdfWords + word); }

float tsdfInBlock(uint slot, uint local) {
  return tsdfOf(tsdfWordInBlock(slot, local >> 1) << (16u - 16u * (local & 1u)));
}
#endif

#ifdef VOLUME_WEIGHT
POOL(weight, VOLUME_WEIGHT)

float weightInBlock(uint slot, uint local) {
  uint word = weightWord(chunkOf(slot), slotInChunk(slot) * kBlockTsdfWords + (local >> 1));
  return float((word >> (16u * (local & 1u))) & 0xFFFFu) * (1.0 / kWeightOne);
}
#endif

#ifdef VOLUME_COLOUR
POOL(colour, VOLUME_COLOUR)
#endif

uint localIndex(ivec3 voxel) {
  ivec3 l = voxel & (kBlockSide - 1);
  return uint((l.z * kBlockSide + l.y) * kBlockSide + l.x);
}

#if defined(VOLUME_TABLE) && defined(VOLUME_TSDF)
// TSDF of the voxel that holds `position`, given in voxels from the table's corner; +1 where nothing was observed.
float tsdfNearest(vec3 position) {
  // Clamped as a float: the border blocks are absent, and the conversion then truncates a positive number.
  vec3 inside = clamp(position, vec3(0.0), vec3(volume.table_size.xyz * kBlockSide) - 0.5);
  ivec3 voxel = ivec3(inside);
  return tsdfInBlock(slotAt(voxel >> 3), localIndex(voxel));
}
#endif
