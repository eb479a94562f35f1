#version 450
#extension GL_GOOGLE_include_directive : require
// Counts the vertices and triangles of every block, so that the host can give each its place in the buffers.
#include "shaders/compute/interface/extract_count.h"

#define VOLUME_UNIFORM_LAYOUT kExtractCountBindLayout
#define VOLUME_TABLE kExtractCountBindTable
#define VOLUME_TSDF kExtractCountBindTsdf
#define VOLUME_WEIGHT kExtractCountBindWeight
#define EXTRACT_CASES kExtractCountBindCases
#define EXTRACT_BEFORE 0
#define EXTRACT_SIDE 9
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/extract.glsl"

layout(local_size_x = kExtractGroup) in;
PUSHED_PARAMETERS(ExtractCountParams)
BLOCKS(kExtractCountBindBlocks)
layout(std430, binding = kExtractCountBindCounts) writeonly restrict buffer Counts { ExtractCount counts[]; };

shared uint s_vertices, s_triangles;

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= params.blocks) return;
  uint lane = gl_LocalInvocationID.x;
  if (lane == 0u) s_vertices = s_triangles = 0u;
  loadSurroundings(blockAt(params.first_slot + item), lane, params.min_weight);
  Rows rows = rowsOf(lane);
  ivec3 crossed = bitCount(crossedEdges(rows));
  atomicAdd(s_vertices, uint(crossed.x + crossed.y + crossed.z));
  atomicAdd(s_triangles, trianglesOf(rows, crossedCells(rows)));
  barrier();
  if (lane == 0u) counts[item] = ExtractCount(s_vertices, s_triangles);
}
