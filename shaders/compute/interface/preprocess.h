// Pass preprocess: 16-bit depth to metres.
#ifndef ROSEFUSION_INTERFACE_PREPROCESS_H
#define ROSEFUSION_INTERFACE_PREPROCESS_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kPreprocessGroup = 64u;     // invocations of a group; one handles two neighbouring pixels
const uint kPreprocessBindRaw = 0u;    // two 16-bit depths per word
const uint kPreprocessBindDepth = 1u;  // float metres, 0 = invalid

const int kEdgeReach = 2;

struct PreprocessParams {
  ivec4 size;  // width, height
  float metres_per_unit;
  float min_depth;  // metres; nearer and farther depths are invalid
  float max_depth;
  // A pixel is invalid where the depths kEdgeReach pixels to both sides leave the plane through it by more
  // than so many standard deviations; 0: edges are kept.
  float edge_sigmas;
  float noise_floor;  // see lib/depth_noise.glsl
  float noise_growth;
  uint pad0;
  uint pad1;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
