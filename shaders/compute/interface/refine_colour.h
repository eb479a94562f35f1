// Pass refine_colour: normal equations of the luminance of image and model at several candidate poses.
#ifndef ROSEFUSION_INTERFACE_REFINE_COLOUR_H
#define ROSEFUSION_INTERFACE_REFINE_COLOUR_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kRefineColourGroup = 64u;  // as in pass refine: x is a part of the points, y the candidate
const uint kRefineColourBindLayout = 0u;
const uint kRefineColourBindTable = 1u;
const uint kRefineColourBindColour = 2u;  // kMaxPoolChunks bindings
const uint kRefineColourBindPoints = 6u;
const uint kRefineColourBindCount = 7u;
const uint kRefineColourBindImage = 8u;       // one word per pixel, red in the low byte
const uint kRefineColourBindCandidates = 9u;  // RefineColourCandidate
const uint kRefineColourBindSums = 10u;       // kRefineColourSums floats per candidate and part
const uint kRefineColourBindings = 11u;

// What is summed over the points whose 27 voxels around all have a colour, in this order. The residual is
// gain * luminance of the model - luminance of the pixel, both in [0, 1]; the unknowns are those of pass
// refine, and the gain.
const uint kRefineColourUnknowns = 7u;
const uint kRefineColourHessian = 0u;    // upper triangle of J^T W J, row by row
const uint kRefineColourGradient = 28u;  // J^T W r
const uint kRefineColourCost = 35u;      // robust cost
const uint kRefineColourPoints = 36u;    // number of the points
const uint kRefineColourSums = 37u;

struct RefineColourCandidate {
  mat4 world_from_camera;
  vec4 gain;  // x: brightness of the frame, in units of the model's; the rest is unused
};

struct RefineColourParams {
  vec4 focal_centre;
  ivec4 size;   // of the image, pixels; z, w: unused
  float huber;  // luminance; larger residuals count linearly
  uint parts;
  uint pad0;
  uint pad1;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
