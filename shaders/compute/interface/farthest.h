// Pass farthest: the largest depth in each tile of the image, by which blocks behind all surfaces are left
// out.
#ifndef ROSEFUSION_INTERFACE_FARTHEST_H
#define ROSEFUSION_INTERFACE_FARTHEST_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kFarthestGroup = 64u;  // invocations along x, one per tile
const int kFarthestTile = 16;     // pixels along its side
const uint kFarthestBindDepth = 0u;
const uint kFarthestBindTiles = 1u;  // float metres per tile, row by row; 0 where none of its pixels is valid

struct FarthestParams {
  ivec4 size;  // width, height of the image, columns and rows of tiles
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
