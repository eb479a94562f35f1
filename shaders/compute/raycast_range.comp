#version 450
#extension GL_GOOGLE_include_directive : require
// Finds the blocks in view that can stop a ray, which are those with a negative voxel, and draws their bounding
// rectangles into a coarse image of depth ranges: rays skip all other blocks, start at the first solid one of their
// tile and end behind the last.
#include "shaders/compute/interface/raycast_range.h"

#define VOLUME_UNIFORM_LAYOUT kRaycastRangeBindLayout
#define VOLUME_TSDF kRaycastRangeBindTsdf
#define VOLUME_TSDF_QUADS
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"

layout(local_size_x = kRaycastRangeGroup) in;
PUSHED_PARAMETERS(RaycastRangeParams)
BLOCKS(kRaycastRangeBindBlocks)
layout(std430, binding = kRaycastRangeBindTiles) restrict buffer Tiles { RaycastTile tiles[]; };
layout(std430, binding = kRaycastRangeBindSolid) writeonly restrict buffer Solid { uint solid[]; };

bool isSolid(uint slot) {
  const uint kStride = 4u;  // cubes looked at before the next test for an end
  const uint kSigns = 0x80008000u;
  uvec4 bits = uvec4(0u);
  bool solid = false;
  for (uint cube = 0u; cube < kBlockVoxels / 8u && !solid; cube += kStride) {
    for (uint i = 0u; i < kStride; ++i) bits |= tsdfCube(slot, cube + i);
    solid = ((bits.x | bits.y | bits.z | bits.w) & kSigns) != 0u;
  }
  return solid;
}

void main() {
  uint slot = gl_GlobalInvocationID.x + 1u;  // slot 0 is the unobserved block
  if (slot > uint(params.size.z)) return;
  float side = float(kBlockSide) * volume.scale.x;
  vec3 corner = (params.camera_from_world * vec4(vec3(blockAt(slot)) * side, 1.0)).xyz;
  float nearest = corner.z, farthest = corner.z;
  for (int axis = 0; axis < 3; ++axis) {
    float reach = params.camera_from_world[axis].z * side;
    nearest += min(reach, 0.0);
    farthest += max(reach, 0.0);
  }
  if (farthest < params.near || nearest > params.far) return;

  ivec2 low = ivec2(0), high = params.size.xy - 1;
  vec2 least = vec2(1e30), most = vec2(-1e30), size = vec2(params.size.xy) * float(kRaycastTile);
  // Whether all corners lie beside the image. Most blocks across the camera's plane do.
  bvec2 before = bvec2(true), beyond = bvec2(true);
  for (int i = 0; i < 8; ++i) {
    vec3 p = corner + mat3(params.camera_from_world) * (vec3(ivec3(i) >> ivec3(0, 1, 2) & 1) * side);
    vec2 scaled = params.focal_centre.xy * p.xy + params.focal_centre.zw * p.z;  // pixel times depth
    before = bvec2(uvec2(before) & uvec2(lessThan(scaled, vec2(-p.z))));
    beyond = bvec2(uvec2(beyond) & uvec2(greaterThan(scaled, size * p.z)));
    least = min(least, scaled / p.z);
    most = max(most, scaled / p.z);
  }
  if (any(before) || any(beyond)) return;
  if (nearest > params.near) {  // else the projection has no bounds: all tiles
    // Clamped as floats: a coordinate far outside would overflow an integer.
    vec2 end = vec2(params.size.xy);
    low = ivec2(clamp(floor(least / float(kRaycastTile)), vec2(0.0), end));
    high = ivec2(clamp(floor(most / float(kRaycastTile)), vec2(-1.0), end - 1.0));
  }
  if (any(greaterThan(low, high)) || !isSolid(slot)) return;
  ivec3 entry = blockAt(slot) - volume.table_origin.xyz;
  solid[(entry.z * volume.table_size.y + entry.y) * volume.table_size.x + entry.x] = slot;
  uint near_bits = floatBitsToUint(max(nearest, params.near)), far_bits = ~floatBitsToUint(min(farthest, params.far));
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      int tile = y * params.size.x + x;
      atomicMin(tiles[tile].nearest, near_bits);
      atomicMin(tiles[tile].farthest_complement, far_bits);
    }
  }
}
