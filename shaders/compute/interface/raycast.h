// Pass raycast: the surface that a camera sees, as normals, depths and a shaded picture.
#ifndef ROSEFUSION_INTERFACE_RAYCAST_H
#define ROSEFUSION_INTERFACE_RAYCAST_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kRaycastGroup = 8u;  // 8 x 8 invocations, one per pixel
const uint kRaycastBindLayout = 0u;
const uint kRaycastBindTable = 1u;
const uint kRaycastBindTsdf = 2u;  // kMaxPoolChunks bindings
const uint kRaycastBindWeight = 6u;
const uint kRaycastBindColour = 10u;
// Two words per pixel: the unit normal towards free space, world frame, as lib/direction.glsl packs it, and
// the bits of the depth along the optical axis, metres; both 0 where nothing was hit. The point hit follows
// from the depth. llvmpipe stores word by word and lane by lane, so what is not written saves much.
const uint kRaycastBindSurface = 14u;
const uint kRaycastBindPreview = 15u;  // one word per pixel: red in the low byte, alpha 255
const uint kRaycastBindTiles = 16u;    // RaycastTile of pass raycast_range
const uint kRaycastBindSolid = 17u;    // its table of the blocks that can stop a ray
const uint kRaycastBindDepth = 18u;    // with kRaycastDepth: float per pixel, see RaycastParams.depth_value
const uint kRaycastBindings = 19u;

const int kRaycastColoured = 1;  // the surface takes its colour from the volume
const int kRaycastClear = 2;     // the preview is 0 where nothing was hit, instead of a backdrop
const int kRaycastDepth = 4;     // the depth image is written

struct RaycastParams {
  mat4 world_from_camera;
  vec4 focal_centre;
  ivec4 size;        // width, height, sum of the flags above, tiles along x
  vec4 depth_value;  // (a, b, c, d): a + b / z + c z for a hit at depth z along the axis, metres; d without a
                     // hit
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
