// Pass allocate: marks the absent blocks along each pixel's truncation band in the page table.
#ifndef ROSEFUSION_INTERFACE_ALLOCATE_H
#define ROSEFUSION_INTERFACE_ALLOCATE_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kAllocateGroup = 8u;  // 8 x 8 invocations, one per sampled pixel
const uint kAllocateBindLayout = 0u;
const uint kAllocateBindTable = 1u;
const uint kAllocateBindDepth = 2u;
const uint kAllocateBindRequests =
    3u;  // AllocateHeader, then the table entries asked for, in no particular order
const uint kAllocateBindings = 4u;         // without what follows
const uint kAllocateBindTableTexels = 4u;  // the table again, where texels are read
const uint kAllocateTexelBindings = 5u;

const float kFarthestRequest = 1e9;  // blocks from the origin; the volume refuses far less

struct AllocateParams {
  mat4 world_from_camera;
  vec4 focal_centre;
  ivec4 size;     // width, height, pixel stride, samples along the band
  uint capacity;  // entries that fit into the requests
  float band;     // half length of the band along the ray, metres
};

struct AllocateHeader {
  uint requested;     // may exceed the capacity: then the rest is not listed
  uint outside;       // samples that fell outside the table
  int outside_min_x;  // their block coordinates
  int outside_min_y;
  int outside_min_z;
  int outside_max_x;
  int outside_max_y;
  int outside_max_z;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
