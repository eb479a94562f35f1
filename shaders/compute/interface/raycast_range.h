// Pass raycast_range: which blocks can stop a ray, and between which depths they lie for each tile of the
// image.
#ifndef ROSEFUSION_INTERFACE_RAYCAST_RANGE_H
#define ROSEFUSION_INTERFACE_RAYCAST_RANGE_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kRaycastRangeGroup = 64u;  // one invocation per block of the volume
const int kRaycastTile = 16;          // pixels
const uint kRaycastRangeBindLayout = 0u;
const uint kRaycastRangeBindBlocks = 1u;
const uint kRaycastRangeBindTsdf = 2u;   // kMaxPoolChunks bindings
const uint kRaycastRangeBindTiles = 6u;  // RaycastTile, row by row
const uint kRaycastRangeBindSolid = 7u;  // like the page table, with the solid blocks in view only
const uint kRaycastRangeBindings = 8u;
const uint kEmptyTile = 0xFFFFFFFFu;  // both words of a tile that sees no block

struct RaycastRangeParams {
  mat4 camera_from_world;
  vec4 focal_centre;
  ivec4 size;  // tiles along x, tiles along y, blocks
  float near;  // limits of the depth along the optical axis, metres
  float far;
};

// Depths as the bits of positive floats, which order like the floats. The farthest is complemented, so that
// one fill value and atomic minima serve both.
struct RaycastTile {
  uint nearest;
  uint farthest_complement;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
