// Pass refine: normal equations of the depth-to-TSDF distance at several candidate poses.
#ifndef ROSEFUSION_INTERFACE_REFINE_H
#define ROSEFUSION_INTERFACE_REFINE_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kRefineGroup =
    64u;  // invocations along x; the x index of the group is a part of the points, y the candidate
const uint kRefineBindLayout = 0u;
const uint kRefineBindTable = 1u;
const uint kRefineBindTsdf = 2u;  // kMaxPoolChunks bindings
const uint kRefineBindPoints = 6u;
const uint kRefineBindCount = 7u;
const uint kRefineBindCandidates = 8u;  // RefineCandidate
const uint kRefineBindSums = 9u;        // kRefineSums floats per candidate and part
const uint kRefineBindWeight = 10u;     // kMaxPoolChunks bindings
const uint kRefineBindings = 14u;

// What is summed over the points, in this order. The unknowns are (x, y, z, wx, wy, wz): a shift of the
// camera in the world and a small turn about the camera's centre, applied on the left.
// J holds only the points whose 27 voxels around are all inside the truncation. The costs hold the points
// that read a distance and those that the last image should have told of: what comes newly into view speaks
// neither for a pose nor against it.
const uint kRefineHessian = 0u;      // upper triangle of J^T W J, row by row
const uint kRefineGradient = 21u;    // J^T W r
const uint kRefineCost = 27u;        // robust cost, the most possible for points without a distance
const uint kRefineMostCost = 28u;    // the same if no point had a distance
const uint kRefineCostWeight = 29u;  // weights, in the cost, of the points that read a distance
const uint kRefineUsable = 30u;  // points that read a distance: all eight voxels around inside the truncation
const uint kRefineClose = 31u;   // of these, nearer to the surface than RefineParams.huber or twice the noise
const uint kRefineRows = 32u;    // y / z of the points that read a distance: how far down the image they are
const uint kRefineSums = 33u;

struct RefineCandidate {
  mat4 world_from_camera;
  mat4 last_image_from_camera;  // to (u z, v z, z) of the last frame's image, pixels
};

struct RefineParams {
  float huber;        // metres; larger residuals count linearly
  float noise_floor;  // see lib/depth_noise.glsl
  float noise_growth;
  uint parts;
  vec4 last_image;    // width, height; z: u z by which a point must lie inside it for its voxels to do so too
  float bias_growth;  // see lib/depth_noise.glsl
  float model_noise;  // of the surface in a voxel of weight 1, metres
  uint front_only;    // 1: points where the model shows a surface's back are left out
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
