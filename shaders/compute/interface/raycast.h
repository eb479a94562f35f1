// Pass raycast: the surface that a camera sees, as points, normals and a shaded picture.
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
const uint kRaycastBindVertices =
    14u;  // vec4 per pixel: world-frame point, w = 1; all 0 where nothing was hit
const uint kRaycastBindNormals =
    15u;  // vec4 per pixel: world-frame unit normal towards free space, w = 1; or all 0
const uint kRaycastBindPreview = 16u;  // one word per pixel: red in the low byte, alpha 255
const uint kRaycastBindTiles = 17u;    // RaycastTile of pass raycast_range
const uint kRaycastBindSolid = 18u;    // its table of the blocks that can stop a ray
const uint kRaycastBindings = 19u;

struct RaycastParams {
  mat4 world_from_camera;
  vec4 focal_centre;
  ivec4 size;  // width, height, 1 to take the surface colour from the volume, tiles along x
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
