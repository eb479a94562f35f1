// What passes select_count and select_points have in common. The includer defines SELECT_COUNTS_ACCESS, how it uses the
// parts' counts.
#include "shaders/compute/interface/select_points.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kSelectGroup) in;
PUSHED_PARAMETERS(SelectParams)
READ_VECTORS(pointAt, kSelectBindPoints)
layout(std430, binding = kSelectBindCounts) SELECT_COUNTS_ACCESS restrict buffer Counts { uvec2 counts[]; };

const uint kAtOnce = 4u;  // loads that are under way together

vec4 gridPoint(uint cell) {
  uint columns = uint(params.grid.z);
  ivec2 at = ivec2(cell % columns, cell / columns) * params.size.z + params.grid.xy;
  return pointAt(uint(at.y * params.size.x + at.x));
}

bool inLastFrame(vec3 p) {
  vec3 q = (params.previous_from_current * vec4(p, 1.0)).xyz;
  vec2 uv = params.focal_centre.xy * q.xy / q.z + params.focal_centre.zw;
  return q.z > 0.0 && all(greaterThanEqual(uv, vec2(-0.5))) && all(lessThan(uv, vec2(params.size.xy) - 0.5));
}

bool wanted(vec4 p) { return p.w > 0.0 && (params.size.w == 0 || inLastFrame(p.xyz)); }

// The cells of this invocation, of its workgroup's part.
uvec2 ownCells() {
  uint cells = uint(params.grid.z * params.grid.w), parts = gl_NumWorkGroups.x, part = gl_WorkGroupID.x;
  uint each = (cells + parts - 1u) / parts, first = min(each * part, cells), past = min(first + each, cells);
  uint share = (past - first + kSelectGroup - 1u) / kSelectGroup;
  uint begin = min(first + gl_LocalInvocationID.x * share, past);
  return uvec2(begin, min(begin + share, past));
}

// Of those, how many are selected, and how many valid.
uvec2 countOwn(uvec2 own) {
  uvec2 mine = uvec2(0u);
  for (uint cell = own.x; cell < own.y; cell += kAtOnce) {
    vec4 p[kAtOnce];
    for (uint k = 0u; k < kAtOnce; ++k) p[k] = gridPoint(min(cell + k, own.y - 1u));
    for (uint k = 0u; k < kAtOnce; ++k)
      if (cell + k < own.y) mine += uvec2(wanted(p[k]), p[k].w > 0.0);
  }
  return mine;
}
