#version 450
#extension GL_GOOGLE_include_directive : require
// The pixels of a subsampling grid that are valid and, moved by the current best pose, fall inside the last frame's
// image [eq:validness], compacted in grid order.
#include "shaders/compute/interface/select_points.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kSelectGroup) in;
PUSHED_PARAMETERS(SelectParams)
READ_VECTORS(pointAt, kSelectBindPoints)
layout(std430, binding = kSelectBindSelected) writeonly restrict buffer Selected { vec4 selected[]; };
layout(std430, binding = kSelectBindCount) writeonly restrict buffer Count { uint count[]; };
layout(std430, binding = kSelectBindTold) writeonly restrict buffer Told { uint told[]; };

shared uvec2 s_before[kSelectGroup];  // selected and valid cells of the lanes up to this one

const uint kAtOnce = 4u;  // loads that are under way together

vec4 gridPoint(uint cell) {
  ivec2 at = ivec2(cell % uint(params.grid.z), cell / uint(params.grid.z)) * params.size.z + params.grid.xy;
  return pointAt(uint(at.y * params.size.x + at.x));
}

bool inLastFrame(vec3 p) {
  vec3 q = (params.previous_from_current * vec4(p, 1.0)).xyz;
  vec2 uv = params.focal_centre.xy * q.xy / q.z + params.focal_centre.zw;
  return q.z > 0.0 && all(greaterThanEqual(uv, vec2(-0.5))) && all(lessThan(uv, vec2(params.size.xy) - 0.5));
}

bool wanted(vec4 p) { return p.w > 0.0 && (params.size.w == 0 || inLastFrame(p.xyz)); }

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint cells = uint(params.grid.z * params.grid.w);
  uint share = (cells + kSelectGroup - 1u) / kSelectGroup;
  uint begin = min(lane * share, cells), end = min(begin + share, cells);
  uvec2 mine = uvec2(0u);
  for (uint cell = begin; cell < end; cell += kAtOnce) {
    vec4 p[kAtOnce];
    for (uint k = 0u; k < kAtOnce; ++k) p[k] = gridPoint(min(cell + k, end - 1u));
    for (uint k = 0u; k < kAtOnce; ++k)
      if (cell + k < end) mine += uvec2(wanted(p[k]), p[k].w > 0.0);
  }
  s_before[lane] = mine;
  for (uint reach = 1u; reach < kSelectGroup; reach *= 2u) {
    barrier();
    uvec2 left = lane >= reach ? s_before[lane - reach] : uvec2(0u);
    barrier();
    s_before[lane] += left;
  }
  if (lane == kSelectGroup - 1u) {
    for (uint k = 0u; k < 2u; ++k) {
      count[k] = s_before[lane][k];
      told[k] = s_before[lane][k];
    }
  }
  uint place = s_before[lane].x - mine.x;
  for (uint cell = begin; cell < end; cell += kAtOnce) {
    vec4 p[kAtOnce];
    for (uint k = 0u; k < kAtOnce; ++k) p[k] = gridPoint(min(cell + k, end - 1u));
    for (uint k = 0u; k < kAtOnce; ++k)
      if (cell + k < end && wanted(p[k])) selected[place++] = p[k];
  }
}
