#version 450
#extension GL_GOOGLE_include_directive : require
// Marks the absent blocks along each pixel's truncation band in the page table and lists them. What falls outside the
// table is only measured: the host then enlarges the table and runs the pass again.
#include "shaders/compute/interface/allocate.h"
#include "shaders/compute/interface/volume.h"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kAllocateGroup, local_size_y = kAllocateGroup) in;
PUSHED_PARAMETERS(AllocateParams)
UNIFORM_PARAMETERS(VolumeLayout, volume, kAllocateBindLayout)
layout(std430, binding = kAllocateBindTable) buffer Table { uint page_table[]; };
#ifdef READ_TEXELS  // a mark of this dispatch may not be seen through them: the exchange decides
READ_WORDS(tableEntry, kAllocateBindTableTexels)
#else
uint tableEntry(uint index) { return page_table[index]; }
#endif
READ_FLOATS(depthAt, kAllocateBindDepth)
layout(std430, binding = kAllocateBindRequests) restrict buffer Requests {
  AllocateHeader header;
  uint requests[];
};

void requestBlockAt(vec3 world) {
  vec3 at = floor(world * (volume.scale.y / float(kBlockSide)));
  // What no integer holds, and what is no number, is as far away as can be said.
  bool sound = all(lessThan(abs(at), vec3(kFarthestRequest)));
  ivec3 block = ivec3(sound ? at : vec3(kFarthestRequest));
  ivec3 entry = block - volume.table_origin.xyz;
  if (any(lessThan(entry, ivec3(1))) || any(greaterThan(entry, volume.table_size.xyz - 2))) {
    atomicAdd(header.outside, 1u);
    atomicMin(header.outside_min_x, block.x);
    atomicMin(header.outside_min_y, block.y);
    atomicMin(header.outside_min_z, block.z);
    atomicMax(header.outside_max_x, block.x);
    atomicMax(header.outside_max_y, block.y);
    atomicMax(header.outside_max_z, block.z);
    return;
  }
  uint index = uint((entry.z * volume.table_size.y + entry.y) * volume.table_size.x + entry.x);
  if (tableEntry(index) != 0u) return;
  if (atomicCompSwap(page_table[index], 0u, kRequested) != 0u) return;
  uint place = atomicAdd(header.requested, 1u);
  if (place < params.capacity) requests[place] = index;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) * params.size.z;
  if (pixel.x >= params.size.x || pixel.y >= params.size.y) return;
  float z = depthAt(uint(pixel.y * params.size.x + pixel.x));
  if (z <= 0.0) return;
  vec3 ray = vec3((vec2(pixel) - params.focal_centre.zw) / params.focal_centre.xy, 1.0);
  vec3 centre = (params.world_from_camera * vec4(ray * z, 1.0)).xyz;
  vec3 along = mat3(params.world_from_camera) * normalize(ray) * params.band;
  for (int i = 0; i < params.size.w; ++i)
    requestBlockAt(centre + along * (2.0 * float(i) / float(params.size.w - 1) - 1.0));
}
