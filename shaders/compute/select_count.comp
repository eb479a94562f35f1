#version 450
#extension GL_GOOGLE_include_directive : require
// Counts, for each part of the grid, the pixels that pass select_points keeps; one workgroup per part.
#define SELECT_COUNTS_ACCESS writeonly
#include "shaders/compute/lib/select_points.glsl"

shared uvec2 s_counts[kSelectGroup];

void main() {
  uint lane = gl_LocalInvocationID.x;
  s_counts[lane] = countOwn(ownCells());
  barrier();
  if (lane > 0u) return;
  uvec2 all = uvec2(0u);
  for (uint i = 0u; i < kSelectGroup; ++i) all += s_counts[i];
  counts[gl_WorkGroupID.x] = all;
}
