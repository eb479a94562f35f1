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
// Behind them, of all pixels: the preview, one word each, red in the low byte, alpha 255; then, with
// kRaycastDepth, the depth image, the bits of a float each, see RaycastParams.depth_value.
const uint kRaycastBindImages = 14u;
const uint kRaycastBindTiles = 15u;  // RaycastTile of pass raycast_range
const uint kRaycastBindSolid = 16u;  // its table of the blocks that can stop a ray
const uint kRaycastBindings = 17u;
const uint kRaycastPreviewAt = 2u;  // words per pixel before it
const uint kRaycastDepthAt = 3u;
const uint kRaycastImageWords = 4u;  // per pixel in all

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
