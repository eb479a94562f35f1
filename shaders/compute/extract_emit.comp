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
#define EXTRACT_CASES kExtractEmitBindListed
#define EXTRACT_BEFORE 1
#define EXTRACT_SIDE 11
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"
#include "shaders/compute/lib/extract.glsl"

layout(local_size_x = kExtractGroup) in;
PUSHED_PARAMETERS(ExtractEmitParams)
BLOCKS(kExtractEmitBindBlocks)
ExtractBlock listedAt(uint i) {
  uint word = kCases * kCaseWords + 4u * i;
  return ExtractBlock(caseWord(word), caseWord(word + 1u), caseWord(word + 2u), caseWord(word + 3u));
}
layout(std430, binding = kExtractEmitBindSurface) writeonly restrict buffer Surface {
  ExtractVertex vertices[kExtractVertices];
  uint triangles[];
};

// Share of an edge that stays free at both ends: vertices of different edges then never coincide, which file formats
// and viewers that merge equal points would turn into holes.
const float kEdgeMargin = 1e-3;

const uint kTriangleUnit = 1u << 16;  // beside the vertices, of which a block has at most kBlockEdges
shared uint s_counts[kExtractGroup];

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

// A voxel's place in its block in the order in which they are written here, x fastest.
uint orderOf(ivec3 voxel) {
  ivec3 v = voxel & 7;
  return uint((v.z * kBlockSide + v.y) * kBlockSide + v.x);
}

ExtractVertex vertexOn(ivec3 block, ivec3 voxel, int axis) {
  ivec3 next = voxel + axisStep(axis);
  float a = valueAt(voxel), b = valueAt(next);
  float share = clamp(a / (a - b), kEdgeMargin, 1.0 - kEdgeMargin);
  vec3 position = (vec3(block * kBlockSide + voxel) + 0.5 + share * vec3(axisStep(axis))) * volume.scale.x;
  vec3 gradient = mix(gradientAt(voxel), gradientAt(next), share);
  vec3 normal = gradient / max(length(gradient), 1e-12);
  uint colour = params.colour != 0u ? mixedColour(colourAt(voxel), colourAt(next), share) : 0u;
  return ExtractVertex(position.x, position.y, position.z, 3u * orderOf(voxel) + uint(axis), normal.x, normal.y, normal.z,
                       colour);
}

// Number over all blocks of a cell's edge; the numbering of edges is that of engine/passes/marching_cubes.h.
uint edgeNumber(ivec3 cell, uint edge) {
  uint axis = edge >> 2, start = (edge & 1u) << (axis + 1u) % 3u | (edge >> 1 & 1u) << (axis + 2u) % 3u;
  ivec3 voxel = cell + (ivec3(start) >> ivec3(0, 1, 2) & 1);
  return slotBeside(voxel >> 3) * kBlockEdges + 3u * orderOf(voxel) + axis;
}

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (item >= params.blocks) return;
  ExtractBlock block = listedAt(item);
  ivec3 coordinate = blockAt(block.slot);
  uint lane = gl_LocalInvocationID.x;
  loadSurroundings(coordinate, lane, params.min_weight);

  Rows rows = rowsOf(lane);
  uvec3 crossed = crossedEdges(rows);
  uint edges = 0u;  // in ascending order, as bits
  [[unroll]] for (uint x = 0u; x < uint(kBlockSide); ++x) {
    uvec3 bits = crossed >> x & 1u;
    edges |= (bits.x | bits.y << 1 | bits.z << 2) << (3u * x);
  }
  uint cells = crossedCells(rows);
  s_counts[lane] = uint(bitCount(edges)) + kTriangleUnit * trianglesOf(rows, cells);
  barrier();
  uint before = 0u;
  for (uint i = 0u; i < lane; ++i) before += s_counts[i];
  uint vertex = block.first_vertex + before % kTriangleUnit, triangle = block.first_triangle + before / kTriangleUnit;

  ivec3 start = rowStart(lane);
  // These test at their ends for the reason that raycast.comp names.
  if (edges != 0u) do {
    int edge = findLSB(edges);
    vertices[vertex++] = vertexOn(coordinate, start + ivec3(edge / 3, 0, 0), edge % 3);
    edges &= edges - 1u;
  } while (edges != 0u);
  if (cells != 0u) do {
    uint x = uint(findLSB(cells)), row = caseOf(rows, x) * kCaseWords, count = caseWord(row), i = 1u;
    do {
      uint word = caseWord(row + i);
      for (uint corner = 0u; corner < 3u; ++corner)
        triangles[3u * triangle + corner] = edgeNumber(start + ivec3(x, 0, 0), word >> (4u * corner) & 15u);
      ++triangle;
    } while (++i <= count);
    cells &= cells - 1u;
  } while (cells != 0u);
}
