// Addressing of the voxel-block volume (see interface/volume.h). The includer defines the bindings it has:
// VOLUME_LAYOUT (a storage buffer) or VOLUME_UNIFORM_LAYOUT (a uniform one), and optionally VOLUME_TABLE, VOLUME_TSDF,
// VOLUME_WEIGHT and VOLUME_COLOUR (first of four each), to read them: storage buffers, or with READ_TEXELS texel buffers.
// With VOLUME_TSDF_QUADS and VOLUME_COLOUR_QUADS they are read by whole cubes faster, and by single voxels slower.
#include "shaders/compute/interface/volume.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(constant_id = 0) const uint kPoolChunks = 1u;  // pool buffers in use; the rest repeat the first

#ifdef VOLUME_UNIFORM_LAYOUT
UNIFORM_PARAMETERS(VolumeLayout, volume, VOLUME_UNIFORM_LAYOUT)
#else
layout(std430, binding = VOLUME_LAYOUT) readonly restrict buffer LayoutBuffer { VolumeLayout volume; };
#endif

// What functions A to D read of the four pools, behind one function. The loop, which each driver unrolls, keeps the choice
// from SwiftShader's search for a loop's blocks: its time doubles with each choice on the way, and it folds no constants first.
#define OF_CHUNKS(TYPE, FUNCTION, A, B, C, D)                   \
  TYPE FUNCTION(uint chunk, uint i) {                           \
    TYPE value;                                                 \
    for (uint once = 0u; once < 1u; ++once) {                   \
      if (kPoolChunks == 1u || chunk == 0u) value = A(i);       \
      else if (kPoolChunks == 2u || chunk == 1u) value = B(i);  \
      else if (kPoolChunks == 3u || chunk == 2u) value = C(i);  \
      else value = D(i);                                        \
    }                                                           \
    return value;                                               \
  }
#define POOL_WORD(NAME) OF_CHUNKS(uint, NAME##Word, NAME##_0, NAME##_1, NAME##_2, NAME##_3)
// Four pools that are only read, on the bindings from FIRST on, by words or also by four of them.
#define POOL_OF(READ, NAME, FIRST) \
  READ(NAME##_0, FIRST)            \
  READ(NAME##_1, FIRST + 1u)       \
  READ(NAME##_2, FIRST + 2u)       \
  READ(NAME##_3, FIRST + 3u)       \
  POOL_WORD(NAME)
#define POOL(NAME, FIRST) POOL_OF(READ_WORDS, NAME, FIRST)
#define QUADS_OF_POOL(NAME, FIRST) \
  POOL_OF(READ_QUADS, NAME, FIRST) \
  OF_CHUNKS(uvec4, NAME##Quad, NAME##_0Quad, NAME##_1Quad, NAME##_2Quad, NAME##_3Quad)
#define QUADS_OF_WORDS(NAME)                                                                                         \
  uvec4 NAME##Quad(uint chunk, uint quad) {                                                                          \
    return uvec4(NAME##Word(chunk, 4u * quad), NAME##Word(chunk, 4u * quad + 1u), NAME##Word(chunk, 4u * quad + 2u), \
                 NAME##Word(chunk, 4u * quad + 3u));                                                                 \
  }

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
#ifdef VOLUME_TSDF_QUADS
QUADS_OF_POOL(tsdf, VOLUME_TSDF)
#else
POOL(tsdf, VOLUME_TSDF)
QUADS_OF_WORDS(tsdf)
#endif

// The cube of 8 voxels with that number in its block. Words are pairs along x: (y0 z0, y1 z0, y0 z1, y1 z1).
uvec4 tsdfCube(uint slot, uint cube) { return tsdfQuad(chunkOf(slot), slotInChunk(slot) * (kBlockTsdfWords / 4u) + cube); }

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
#ifdef VOLUME_COLOUR_QUADS
QUADS_OF_POOL(colour, VOLUME_COLOUR)
#else
POOL(colour, VOLUME_COLOUR)
QUADS_OF_WORDS(colour)
#endif

// Colours of a cube's lower or upper layer, of which a block has 128: (x0 y0, x1 y0, x0 y1, x1 y1).
uvec4 colourQuadInBlock(uint slot, uint quad) {
  return colourQuad(chunkOf(slot), slotInChunk(slot) * (kBlockColourWords / 4u) + quad);
}
#endif

// Number of a voxel within its block: by cubes of 2^3 (see interface/volume.h).
uint localIndex(ivec3 voxel) {
  ivec3 cube = (voxel & 6) << ivec3(2, 4, 6), one = (voxel & 1) << ivec3(0, 1, 2);
  return uint((cube.x | cube.y | cube.z) | (one.x | one.y | one.z));
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
