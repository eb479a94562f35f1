// Pass select_points: the pixels of a subsampling grid that lie in the overlap set [eq:validness], compacted.
#ifndef ROSEFUSION_INTERFACE_SELECT_POINTS_H
#define ROSEFUSION_INTERFACE_SELECT_POINTS_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kSelectGroup =
    128u;  // one workgroup in all: its order is the grid order, so results are reproducible
const uint kSelectBindPoints = 0u;
const uint kSelectBindSelected = 1u;  // vec4 camera-frame points, compacted
const uint kSelectBindCount = 2u;     // [0]: points selected, [1]: valid grid pixels
const uint kSelectBindTold = 3u;      // the same where the host reads it, which is far from the device's own

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
