#version 450
#extension GL_GOOGLE_include_directive : require
// The pixels of a subsampling grid that are valid and, moved by the current best pose, fall inside the last frame's
// image [eq:validness], compacted in grid order; one workgroup per part of the grid.
#define SELECT_COUNTS_ACCESS readonly
#include "shaders/compute/lib/select_points.glsl"

layout(std430, binding = kSelectBindSelected) writeonly restrict buffer Selected { vec4 selected[]; };
layout(std430, binding = kSelectBindCount) writeonly restrict buffer Count { uint count[]; };
layout(std430, binding = kSelectBindTold) writeonly restrict buffer Told { uint told[]; };

shared uvec2 s_before[kSelectGroup];  // selected and valid cells of the lanes up to this one

void main() {
  uint lane = gl_LocalInvocationID.x, part = gl_WorkGroupID.x;
  uvec2 own = ownCells(), mine = countOwn(own);
  s_before[lane] = mine;
  for (uint reach = 1u; reach < kSelectGroup; reach *= 2u) {
    barrier();
    uvec2 left = lane >= reach ? s_before[lane - reach] : uvec2(0u);
    barrier();
    s_before[lane] += left;
  }
  uvec2 parts_before = uvec2(0u);
  for (uint i = 0u; i < part; ++i) parts_before += counts[i];
  uvec2 up_to = parts_before + s_before[lane];
  if (part == gl_NumWorkGroups.x - 1u && lane == kSelectGroup - 1u) {
    for (uint k = 0u; k < 2u; ++k) {
      count[k] = up_to[k];
      told[k] = up_to[k];
    }
  }
  uint place = up_to.x - mine.x;
  for (uint cell = own.x; cell < own.y; cell += kAtOnce) {
    vec4 p[kAtOnce];
    for (uint k = 0u; k < kAtOnce; ++k) p[k] = gridPoint(min(cell + k, own.y - 1u));
    for (uint k = 0u; k < kAtOnce; ++k)
      if (cell + k < own.y && wanted(p[k])) selected[place++] = p[k];
  }
}
