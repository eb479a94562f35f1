#version 450
#extension GL_GOOGLE_include_directive : require
// Counts the vertices and triangles of every block, so that the host can give each its place in the buffers.
#include "shaders/compute/interface/extract_count.h"

#define VOLUME_UNIFORM_LAYOUT kExtractCountBindLayout
#define VOLUME_TABLE kExtractCountBindTable
#define VOLUME_TSDF kExtractCountBindTsdf
#define VOLUME_WEIGHT kExtractCountBindWeight
#define EXTRACT_BEFORE 0
#define EXTRACT_SIDE 9
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/extract.glsl"

layout(local_size_x = kExtractGroup) in;
PUSHED_PARAMETERS(ExtractCountParams)
BLOCKS(kExtractCountBindBlocks)
READ_WORDS(caseWord, kExtractCountBindCases)
layout(std430, binding = kExtractCountBindCounts) writeonly restrict buffer Counts { ExtractCount counts[]; };

shared uint s_vertices[kExtractGroup];
shared uint s_triangles[kExtractGroup];

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= params.blocks) return;
  uint lane = gl_LocalInvocationID.x;
  loadSurroundings(blockAt(params.first_slot + item), lane, params.min_weight);
  uint vertices = 0u, triangles = 0u;
  for (int x = 0; x < kBlockSide; ++x) {
    ivec3 voxel = rowStart(lane) + ivec3(x, 0, 0);
    float value = valueAt(voxel);
    for (int axis = 0; axis < 3; ++axis) vertices += uint(crosses(value, valueAt(voxel + axisStep(axis))));
    triangles += caseWord(caseAt(voxel) * kCaseWords);
  }
  s_vertices[lane] = vertices;
  s_triangles[lane] = triangles;
  barrier();
  if (lane != 0u) return;
  ExtractCount total = ExtractCount(0u, 0u);
  for (uint i = 0u; i < kExtractGroup; ++i) {
    total.vertices += s_vertices[i];
    total.triangles += s_triangles[i];
  }
  counts[item] = total;
}
