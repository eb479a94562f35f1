// Pass extract_emit: the vertices and triangles of the blocks that extract_count counted.
// A vertex lies on the edge between a voxel and its next one along an axis, and belongs to that voxel's
// block. An edge's number within its block is 3 * (voxel within the block) + axis; over all blocks,
// kBlockEdges * slot more.
#ifndef ROSEFUSION_INTERFACE_EXTRACT_EMIT_H
#define ROSEFUSION_INTERFACE_EXTRACT_EMIT_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kBlockEdges = 1536u;
const uint kExtractEmitBindLayout = 0u;
const uint kExtractEmitBindTable = 1u;
const uint kExtractEmitBindBlocks = 2u;
const uint kExtractEmitBindTsdf = 3u;  // kMaxPoolChunks bindings
const uint kExtractEmitBindWeight = 7u;
const uint kExtractEmitBindColour = 11u;
const uint kExtractEmitBindListed = 15u;  // the table of cases, then an ExtractBlock per workgroup
// kExtractVertices times ExtractVertex, per block in ascending order of their edges, then three edges per
// triangle.
const uint kExtractEmitBindSurface = 16u;
const uint kExtractEmitBindings = 17u;
const uint kExtractVertices = 262144u;  // of a batch; a block has at most kBlockEdges

struct ExtractEmitParams {
  uint blocks;
  float min_weight;  // as in ExtractCountParams
  uint colour;       // 1 when the volume has colour
  uint pad0;
};

struct ExtractBlock {  // read word by word
  uint slot;
  uint first_vertex;    // among the vertices
  uint first_triangle;  // among the triangles
  uint pad0;
};

struct ExtractVertex {
  float x;  // world frame, metres
  float y;
  float z;
  uint edge;       // within its block
  float normal_x;  // unit length, towards free space; 0 where the TSDF is flat
  float normal_y;
  float normal_z;
  uint colour;  // red in the low byte; top byte 255 where a colour was seen, else all 0
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
