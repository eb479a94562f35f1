#version 450
#extension GL_GOOGLE_include_directive : require
// Writes the surface of the listed blocks: vertices where an edge between two voxels crosses zero, triangles as triples
// of edges, both in the order of their voxels.
#include "shaders/compute/interface/extract_emit.h"

#define VOLUME_UNIFORM_LAYOUT kExtractEmitBindLayout
#define VOLUME_TABLE kExtractEmitBindTable
#define VOLUME_TSDF kExtractEmitBindTsdf
#define VOLUME_WEIGHT kExtractEmitBindWeight
#define VOLUME_COLOUR kExtractEmitBindColour
#define EXTRACT_BEFORE 1
#define EXTRACT_SIDE 11
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/extract.glsl"

layout(local_size_x = kExtractGroup) in;
PUSHED_PARAMETERS(ExtractEmitParams)
BLOCKS(kExtractEmitBindBlocks)
READ_WORDS(caseWord, kExtractEmitBindCases)
#ifdef READ_TEXELS
READ_WORDS(listedWord, kExtractEmitBindListed)
ExtractBlock listedAt(uint i) {
  return ExtractBlock(listedWord(4u * i), listedWord(4u * i + 1u), listedWord(4u * i + 2u), listedWord(4u * i + 3u));
}
#else
layout(std430, binding = kExtractEmitBindListed) readonly restrict buffer Listed { ExtractBlock listed[]; };
ExtractBlock listedAt(uint i) { return listed[i]; }
#endif
layout(std430, binding = kExtractEmitBindVertices) writeonly restrict buffer Vertices { ExtractVertex vertices[]; };
layout(std430, binding = kExtractEmitBindTriangles) writeonly restrict buffer Triangles { uint triangles[]; };

// Share of an edge that stays free at both ends: vertices of different edges then never coincide, which file formats
// and viewers that merge equal points would turn into holes.
const float kEdgeMargin = 1e-3;

shared uint s_vertices[kExtractGroup];
shared uint s_triangles[kExtractGroup];

// Slope of the TSDF at a voxel, one-sided beside unobserved voxels.
float slopeAt(ivec3 voxel, float value, ivec3 along) {
  float before = valueAt(voxel - along), after = valueAt(voxel + along);
  bool has_before = before < kNotObserved, has_after = after < kNotObserved;
  float scale = has_before && has_after ? 0.5 : 1.0;
  return scale * ((has_after ? after : value) - (has_before ? before : value));
}

vec3 gradientAt(ivec3 voxel) {
  float value = valueAt(voxel);
  return vec3(slopeAt(voxel, value, axisStep(0)), slopeAt(voxel, value, axisStep(1)), slopeAt(voxel, value, axisStep(2)));
}

uint colourAt(ivec3 voxel) {
  uint slot = slotBeside(voxel >> 3);
  return colourWord(chunkOf(slot), slotInChunk(slot) * kBlockColourWords + localIndex(voxel));
}

uint mixedColour(uint a, uint b, float share) {
  bool has_a = a >> 24 > 0u, has_b = b >> 24 > 0u;
  if (!has_a && !has_b) return 0u;
  vec3 mixed = mix(unpackUnorm4x8(a).xyz, unpackUnorm4x8(b).xyz, has_a && has_b ? share : float(has_b));
  return packUnorm4x8(vec4(mixed, 1.0));
}

ExtractVertex vertexOn(ivec3 block, ivec3 voxel, int axis) {
  ivec3 next = voxel + axisStep(axis);
  float a = valueAt(voxel), b = valueAt(next);
  float share = clamp(a / (a - b), kEdgeMargin, 1.0 - kEdgeMargin);
  vec3 position = (vec3(block * kBlockSide + voxel) + 0.5 + share * vec3(axisStep(axis))) * volume.scale.x;
  vec3 gradient = mix(gradientAt(voxel), gradientAt(next), share);
  vec3 normal = gradient / max(length(gradient), 1e-12);
  uint colour = params.colour != 0u ? mixedColour(colourAt(voxel), colourAt(next), share) : 0u;
  return ExtractVertex(position.x, position.y, position.z, 3u * localIndex(voxel) + uint(axis), normal.x, normal.y, normal.z,
                       colour);
}

// Number over all blocks of a cell's edge; the numbering of edges is that of engine/passes/marching_cubes.h.
uint edgeNumber(ivec3 cell, uint edge) {
  uint axis = edge >> 2, start = (edge & 1u) << (axis + 1u) % 3u | (edge >> 1 & 1u) << (axis + 2u) % 3u;
  ivec3 voxel = cell + (ivec3(start) >> ivec3(0, 1, 2) & 1);
  return slotBeside(voxel >> 3) * kBlockEdges + 3u * localIndex(voxel) + axis;
}

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= params.blocks) return;
  ExtractBlock block = listedAt(item);
  ivec3 coordinate = blockAt(block.slot);
  uint lane = gl_LocalInvocationID.x;
  loadSurroundings(coordinate, lane, params.min_weight);

  uint crossings = 0u, faces = 0u;
  for (int x = 0; x < kBlockSide; ++x) {
    ivec3 voxel = rowStart(lane) + ivec3(x, 0, 0);
    float value = valueAt(voxel);
    for (int axis = 0; axis < 3; ++axis) crossings += uint(crosses(value, valueAt(voxel + axisStep(axis))));
    faces += caseWord(caseAt(voxel) * kCaseWords);
  }
  s_vertices[lane] = crossings;
  s_triangles[lane] = faces;
  barrier();
  uint vertex = block.first_vertex, triangle = block.first_triangle;
  for (uint i = 0u; i < lane; ++i) {
    vertex += s_vertices[i];
    triangle += s_triangles[i];
  }

  for (int x = 0; x < kBlockSide; ++x) {
    ivec3 voxel = rowStart(lane) + ivec3(x, 0, 0);
    float value = valueAt(voxel);
    for (int axis = 0; axis < 3; ++axis)
      if (crosses(value, valueAt(voxel + axisStep(axis)))) vertices[vertex++] = vertexOn(coordinate, voxel, axis);
    uint row = caseAt(voxel) * kCaseWords;
    uint count = caseWord(row);
    for (uint i = 1u; i <= count; ++i, ++triangle)
      for (uint corner = 0u; corner < 3u; ++corner)
        triangles[3u * triangle + corner] = edgeNumber(voxel, caseWord(row + i) >> (4u * corner) & 15u);
  }
}
