#version 450
#extension GL_GOOGLE_include_directive : require
// Sums up the valid depths of square cells of the image, from pixels or from four cells of the level below, so that a plane
// can be fitted through those of any cell.
#include "shaders/compute/interface/footprint.h"
#include "shaders/compute/lib/moments.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kFootprintGroup) in;
PUSHED_PARAMETERS(MomentsParams)
READ_FLOATS(depthAt, kMomentsBindDepth)
READ_VECTORS(finerAt, kMomentsBindFiner)
layout(std430, binding = kMomentsBindCells) writeonly restrict buffer Cells { vec4 cells[]; };

Moments ofPixels(ivec2 first) {
  Moments sum = noMoments();
  for (int i = 0; i < kFootprintSide * kFootprintSide; ++i) {
    ivec2 at = first + ivec2(i % kFootprintSide, i / kFootprintSide);
    bool inside = all(lessThan(at, params.size.xy));
    float z = inside ? depthAt(uint(at.y * params.size.x + at.x)) : 0.0;
    if (z > 0.0) sum = merged(sum, momentsOf(vec2(at), 1.0 / z));
  }
  return sum;
}

Moments ofCells(ivec2 first) {
  Moments sum = noMoments();
  for (int i = 0; i < 4; ++i) {
    ivec2 at = first + ivec2(i & 1, i >> 1);
    if (any(greaterThanEqual(at, params.size.zw))) continue;
    uint cell = kMomentVectors * uint(at.y * params.size.z + at.x);
    sum = merged(sum, unpacked(finerAt(cell), finerAt(cell + 1u), finerAt(cell + 2u)));
  }
  return sum;
}

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  int cell = int(group * kFootprintGroup + gl_LocalInvocationID.x);
  if (cell >= params.cells.x * params.cells.y) return;
  ivec2 at = ivec2(cell % params.cells.x, cell / params.cells.x);
  Moments m = params.cells.z == 0 ? ofPixels(kFootprintSide * at) : ofCells(2 * at);
  uint place = kMomentVectors * uint(cell);
  cells[place] = vec4(m.n, m.at, m.q);
  cells[place + 1u] = vec4(m.uu, m.uv, m.vv, m.qq);
  cells[place + 2u] = vec4(m.with_q, 0.0, 0.0);
}
