// Addressing of the voxel-block volume (see interface/volume.h). The includer defines the bindings it has:
// VOLUME_LAYOUT, and optionally VOLUME_TABLE, VOLUME_TSDF, VOLUME_WEIGHT, VOLUME_COLOUR (first of four each), and
// VOLUME_ACCESS (readonly, or empty to write).
#include "shaders/compute/interface/volume.h"

layout(constant_id = 0) const uint kPoolChunks = 1u;  // pool buffers in use; the rest repeat the first

layout(std430, binding = VOLUME_LAYOUT) readonly restrict buffer LayoutBuffer { VolumeLayout volume; };

#define POOL(NAME, FIRST)                                                                    \
  layout(std430, binding = FIRST) VOLUME_ACCESS restrict buffer NAME##0 { uint NAME##_0[]; };       \
  layout(std430, binding = FIRST + 1u) VOLUME_ACCESS restrict buffer NAME##1 { uint NAME##_1[]; };  \
  layout(std430, binding = FIRST + 2u) VOLUME_ACCESS restrict buffer NAME##2 { uint NAME##_2[]; };  \
  layout(std430, binding = FIRST + 3u) VOLUME_ACCESS restrict buffer NAME##3 { uint NAME##_3[]; };  \
  uint NAME##Word(uint chunk, uint word) {                                                   \
    if (kPoolChunks == 1u || chunk == 0u) return NAME##_0[word];                             \
    if (kPoolChunks == 2u || chunk == 1u) return NAME##_1[word];                             \
    if (kPoolChunks == 3u || chunk == 2u) return NAME##_2[word];                             \
    return NAME##_3[word];                                                                   \
  }
// The same, read only, through texel buffers, which the includer asks for with VOLUME_TEXELS: llvmpipe gathers texels
// for all lanes at once, where it loads the words of a storage buffer lane by lane.
#define TEXEL_POOL(NAME, FIRST)                                                    \
  layout(binding = FIRST) uniform usamplerBuffer NAME##_0;                         \
  layout(binding = FIRST + 1u) uniform usamplerBuffer NAME##_1;                    \
  layout(binding = FIRST + 2u) uniform usamplerBuffer NAME##_2;                    \
  layout(binding = FIRST + 3u) uniform usamplerBuffer NAME##_3;                    \
  uint NAME##Word(uint chunk, uint word) {                                         \
    if (kPoolChunks == 1u || chunk == 0u) return texelFetch(NAME##_0, int(word)).x; \
    if (kPoolChunks == 2u || chunk == 1u) return texelFetch(NAME##_1, int(word)).x; \
    if (kPoolChunks == 3u || chunk == 2u) return texelFetch(NAME##_2, int(word)).x; \
    return texelFetch(NAME##_3, int(word)).x;                                      \
  }
#define POOL_WRITER(NAME)                                                                    \
  void set##NAME##Word(uint chunk, uint word, uint value) {                                  \
    if (kPoolChunks == 1u || chunk == 0u) NAME##_0[word] = value;                            \
    else if (kPoolChunks == 2u || chunk == 1u) NAME##_1[word] = value;                       \
    else if (kPoolChunks == 3u || chunk == 2u) NAME##_2[word] = value;                       \
    else NAME##_3[word] = value;                                                             \
  }

uint chunkOf(uint slot) { return kPoolChunks == 1u ? 0u : slot >> uint(volume.table_origin.w); }
uint slotInChunk(uint slot) { return kPoolChunks == 1u ? slot : slot & ((1u << uint(volume.table_origin.w)) - 1u); }

float tsdfOf(uint bits16_high) { return max(float(int(bits16_high) >> 16) * (1.0 / 32767.0), -1.0); }

#ifdef VOLUME_TABLE
#ifdef VOLUME_TEXELS
layout(binding = VOLUME_TABLE) uniform usamplerBuffer page_table;
uint tableEntry(int entry) { return texelFetch(page_table, entry).x; }
#else
layout(std430, binding = VOLUME_TABLE) readonly restrict buffer TableBuffer { uint page_table[]; };
uint tableEntry(int entry) { return page_table[entry]; }
#endif

// Slot of the block at table coordinate `entry`, which must lie inside the table; 0 when absent.
uint slotAt(ivec3 entry) {
  return tableEntry((entry.z * volume.table_size.y + entry.y) * volume.table_size.x + entry.x);
}
ivec3 clampToTable(ivec3 entry) { return clamp(entry, ivec3(0), volume.table_size.xyz - 1); }
#endif

#ifdef VOLUME_TSDF
#ifdef VOLUME_TEXELS
TEXEL_POOL(tsdf, VOLUME_TSDF)
#else
POOL(tsdf, VOLUME_TSDF)
#endif

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
#ifdef VOLUME_TEXELS
TEXEL_POOL(colour, VOLUME_COLOUR)
#else
POOL(colour, VOLUME_COLOUR)
#endif
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
