// Pass integrate: fuses one depth image into the listed blocks (paper: Curless and Levoy 1996 running mean).
#ifndef ROSEFUSION_INTERFACE_INTEGRATE_H
#define ROSEFUSION_INTERFACE_INTEGRATE_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kIntegrateGroup = 64u;  // one workgroup per block; an invocation owns a row of 8 voxels along x
const uint kIntegrateBindLayout = 0u;
const uint kIntegrateBindBlocks = 1u;   // ivec4 block coordinate per slot
const uint kIntegrateBindVisible = 2u;  // slots to update
const uint kIntegrateBindDepth = 3u;
const uint kIntegrateBindColourImage = 4u;  // one word per pixel, red in the low byte; unused without colour
const uint kIntegrateBindTsdf = 5u;         // kMaxPoolChunks bindings
const uint kIntegrateBindWeight = 9u;
const uint kIntegrateBindColour = 13u;
const uint kIntegrateBindings = 17u;        // without what follows
const uint kIntegrateBindTsdfTexels = 17u;  // the pools again, where texels are read
const uint kIntegrateBindWeightTexels = 21u;
const uint kIntegrateBindColourTexels = 25u;
const uint kIntegrateTexelBindings = 29u;

struct IntegrateParams {
  mat4 camera_from_world;
  vec4 focal_centre;
  ivec4 size;         // width, height, listed blocks; w: unused
  float noise_floor;  // see lib/depth_noise.glsl; the weight of a depth is its inverse variance, 1 when near
  float noise_growth;
  float bias_growth;
  uint thin_walls;  // 1: behind surfaces, of views that contradict each other one counts
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
