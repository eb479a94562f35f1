#version 450
#extension GL_GOOGLE_include_directive : require
// The largest depth in each tile of the image. One invocation walks a tile: a software device pays for barriers.
#include "shaders/compute/interface/farthest.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kFarthestGroup) in;
PUSHED_PARAMETERS(FarthestParams)
READ_FLOATS(depthAt, kFarthestBindDepth)
layout(std430, binding = kFarthestBindTiles) writeonly restrict buffer Tiles { float tiles[]; };

void main() {
  int tile = int(gl_GlobalInvocationID.x);
  if (tile >= params.size.z * params.size.w) return;
  ivec2 corner = ivec2(tile % params.size.z, tile / params.size.z) * kFarthestTile;
  float farthest = 0.0;
  for (int y = 0; y < kFarthestTile; ++y)
    for (int x = 0; x < kFarthestTile; ++x) {
      ivec2 at = min(corner + ivec2(x, y), params.size.xy - 1);
      farthest = max(farthest, depthAt(uint(at.y * params.size.x + at.x)));
    }
  tiles[tile] = farthest;
}
