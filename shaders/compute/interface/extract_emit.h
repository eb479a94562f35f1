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
const uint kExtractEmitBindCases = 15u;
const uint kExtractEmitBindListed = 16u;     // ExtractBlock per workgroup
const uint kExtractEmitBindVertices = 17u;   // ExtractVertex, per block in ascending order of their edges
const uint kExtractEmitBindTriangles = 18u;  // three edges per triangle
const uint kExtractEmitBindings = 19u;

struct ExtractEmitParams {
  uint blocks;
  float min_weight;  // as in ExtractCountParams
  uint colour;       // 1 when the volume has colour
  uint pad0;
};

struct ExtractBlock {
  uint slot;
  uint first_vertex;    // in the vertex buffer
  uint first_triangle;  // in the triangle buffer
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
