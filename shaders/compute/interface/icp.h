// Pass icp: normal equations of the point-to-plane distance between a frame and the raycast model.
#ifndef ROSEFUSION_INTERFACE_ICP_H
#define ROSEFUSION_INTERFACE_ICP_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kIcpGroup = 64u;       // invocations along x; the group's index is a part of the pixels
const uint kIcpBindPoints = 0u;   // of pass preprocess
const uint kIcpBindSurface = 1u;  // of pass raycast
const uint kIcpBindModel = 2u;    // IcpModel
const uint kIcpBindSums = 3u;     // kIcpSums floats per part
const uint kIcpBindings = 4u;
const int kIcpReach = 4;  // pixels to every side from which a pixel's normal is made

// What is summed over the pairs, in this order; the unknowns are those of pass refine.
const uint kIcpHessian = 0u;    // upper triangle of J^T J, row by row
const uint kIcpGradient = 21u;  // J^T r
const uint kIcpSquares = 27u;   // r^2
const uint kIcpPairs = 28u;     // how many there are
const uint kIcpSums = 29u;

// Whom the frame is paired with, and how.
struct IcpModel {
  mat4 camera_from_world;  // from where the model was raycast
  vec4 focal_centre;
  ivec4 size;      // width, height; z, w: unused
  ivec4 grid;      // stride, offset, columns, rows of the frame's pixels that are looked at
  float distance;  // metres between the points of a pair, at most
  float cosine;    // between their normals, at least
  float pad0;
  float pad1;
};

struct IcpParams {
  mat4 world_from_camera;  // the frame's pose so far
  uint parts;
  uint pad0;
  uint pad1;
  uint pad2;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
