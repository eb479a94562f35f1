#version 450
#extension GL_GOOGLE_include_directive : require
// The pixels of a subsampling grid that are valid and, moved by the current best pose, fall inside the last frame's
// image [eq:validness], compacted in grid order.
#include "shaders/compute/interface/select_points.h"

layout(local_size_x = kSelectGroup) in;
layout(push_constant) uniform Push { SelectParams params; };
layout(std430, binding = kSelectBindPoints) readonly restrict buffer Points { vec4 points[]; };
layout(std430, binding = kSelectBindSelected) writeonly restrict buffer Selected { vec4 selected[]; };
layout(std430, binding = kSelectBindCount) writeonly restrict buffer Count { uint count[]; };

shared uint s_selected[kSelectGroup];
shared uint s_valid[kSelectGroup];

vec4 gridPoint(uint cell) {
  ivec2 at = ivec2(cell % uint(params.grid.z), cell / uint(params.grid.z)) * params.size.z + params.grid.xy;
  return points[at.y * params.size.x + at.x];
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
  uint mine = 0u, valid = 0u;
  for (uint cell = begin; cell < end; ++cell) {
    vec4 p = gridPoint(cell);
    if (p.w > 0.0) ++valid;
    if (wanted(p)) ++mine;
  }
  s_selected[lane] = mine;
  s_valid[lane] = valid;
  barrier();
  uint place = 0u;
  for (uint i = 0u; i < lane; ++i) place += s_selected[i];
  if (lane == kSelectGroup - 1u) {
    uint total_valid = 0u;
    for (uint i = 0u; i < kSelectGroup; ++i) total_valid += s_valid[i];
    count[0] = place + mine;
    count[1] = total_valid;
  }
  for (uint cell = begin; cell < end; ++cell) {
    vec4 p = gridPoint(cell);
    if (wanted(p)) selected[place++] = p;
  }
}
