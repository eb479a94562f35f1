// Passes select_count and select_points: the pixels of a subsampling grid that lie in the overlap set
// [eq:validness], compacted in grid order, so that results are reproducible.
#ifndef ROSEFUSION_INTERFACE_SELECT_POINTS_H
#define ROSEFUSION_INTERFACE_SELECT_POINTS_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kSelectGroup = 64u;  // invocations; a workgroup has one part of the grid
const uint kSelectBindPoints = 0u;
const uint kSelectBindCounts = 1u;  // uvec2 per part: points selected, valid grid pixels
const uint kSelectCountBindings = 2u;
const uint kSelectBindSelected = 2u;  // vec4 camera-frame points, compacted
const uint kSelectBindCount = 3u;     // [0]: points selected, [1]: valid grid pixels
const uint kSelectBindTold = 4u;      // the same where the host reads it, which is far from the device's own
const uint kSelectBindings = 5u;

struct SelectParams {
  mat4 previous_from_current;  // the last frame's camera from this one's, at the current best pose
  vec4 focal_centre;
  ivec4 size;  // width, height, stride, 1 to demand overlap with the last frame
  ivec4 grid;  // x offset, y offset, columns, rows
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
