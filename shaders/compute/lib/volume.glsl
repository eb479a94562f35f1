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

// A pool is up to four buffers, its chunks. These declare one that is only read, on the bindings from FIRST on, each chunk
// behind a function as lib/read.glsl makes them: NAME_0(i) to NAME_3(i), of quads NAME_0Quad(i) to NAME_3Quad(i) beside them.
#define READ_WORD_POOL(NAME, FIRST) \
  READ_WORDS(NAME##_0, FIRST)       \
  READ_WORDS(NAME##_1, FIRST + 1u)  \
  READ_WORDS(NAME##_2, FIRST + 2u)  \
  READ_WORDS(NAME##_3, FIRST + 3u)
#define READ_QUAD_POOL(NAME, FIRST) \
  READ_QUADS(NAME##_0, FIRST)       \
  READ_QUADS(NAME##_1, FIRST + 1u)  \
  READ_QUADS(NAME##_2, FIRST + 2u)  \
  READ_QUADS(NAME##_3, FIRST + 3u)

// FUNCTION(chunk, i), which asks that one of the chunks' functions A to D. The loop, which each driver unrolls, keeps the choice
// from SwiftShader's search for a loop's blocks: its time doubles with each choice on the way, and it folds no constants first.
#define CHUNK_FUNCTION(TYPE, FUNCTION, A, B, C, D)              \
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
READ_QUAD_POOL(tsdf, VOLUME_TSDF)
#else
READ_WORD_POOL(tsdf, VOLUME_TSDF)
#endif
CHUNK_FUNCTION(uint, tsdfWord, tsdf_0, tsdf_1, tsdf_2, tsdf_3)
#ifdef VOLUME_TSDF_QUADS
CHUNK_FUNCTION(uvec4, tsdfQuad, tsdf_0Quad, tsdf_1Quad, tsdf_2Quad, tsdf_3Quad)
#else
uvec4 tsdfQuad(uint chunk, uint quad) {
  return uvec4(tsdfWord(chunk, 4u * quad), tsdfWord(chunk, 4u * quad + 1u), tsdfWord(chunk, 4u * quad + 2u),
               tsdfWord(chunk, 4u * quad + 3u));
}
#endif

// The cube of 8 voxels with that number in its block. Words are pairs along x: (y0 z0, y1 z0, y0 z1, y1 z1).
uvec4 tsdfCube(uint slot, uint cube) { return tsdfQuad(chunkOf(slot), slotInChunk(slot) * (kBlockTsdfWords / 4u) + cube); }

uint tsdfWordInBlock(uint slot, uint word) { return tsdfWord(chunkOf(slot), slotInChunk(slot) * kBlockTsdfWords + word); }

float tsdfInBlock(uint slot, uint local) {
  return tsdfOf(tsdfWordInBlock(slot, local >> 1) << (16u - 16u * (local & 1u)));
}
#endif

#ifdef VOLUME_WEIGHT
READ_WORD_POOL(weight, VOLUME_WEIGHT)
CHUNK_FUNCTION(uint, weightWord, weight_0, weight_1, weight_2, weight_3)

float weightInBlock(uint slot, uint local) {
  uint word = weightWord(chunkOf(slot), slotInChunk(slot) * kBlockTsdfWords + (local >> 1));
  return float((word >> (16u * (local & 1u))) & 0xFFFFu) * (1.0 / kWeightOne);
}
#endif

#ifdef VOLUME_COLOUR
#ifdef VOLUME_COLOUR_QUADS
READ_QUAD_POOL(colour, VOLUME_COLOUR)
#else
READ_WORD_POOL(colour, VOLUME_COLOUR)
#endif
CHUNK_FUNCTION(uint, colourWord, colour_0, colour_1, colour_2, colour_3)
#ifdef VOLUME_COLOUR_QUADS
CHUNK_FUNCTION(uvec4, colourQuad, colour_0Quad, colour_1Quad, colour_2Quad, colour_3Quad)
#else
uvec4 colourQuad(uint chunk, uint quad) {
  return uvec4(colourWord(chunk, 4u * quad), colourWord(chunk, 4u * quad + 1u), colourWord(chunk, 4u * quad + 2u),
               colourWord(chunk, 4u * quad + 3u));
}
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
