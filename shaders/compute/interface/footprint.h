// Passes depth_moments and footprint: what a voxel, not only a pixel, sees of a depth image.
#ifndef ROSEFUSION_INTERFACE_FOOTPRINT_H
#define ROSEFUSION_INTERFACE_FOOTPRINT_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const int kFootprintSide = 4;      // pixels along a cell of the first level; each level doubles it
const int kFootprintLevels = 4;    // 4, 8, 16 and 32 pixels
const uint kFootprintGroup = 64u;  // invocations, one per cell
const uint kMomentVectors = 3u;    // vec4 per cell, see MomentsParams

const uint kMomentsBindDepth = 0u;
const uint kMomentsBindFiner = 1u;  // the level below; unused by the first
const uint kMomentsBindCells = 2u;

// Of the valid pixels (u, v) of a cell, with q = 1 / z, which is linear in the image on any plane: number,
// means of u, v and q; then sums of products of the deviations from these: uu, uv, vv, qq; uq, vq.
struct MomentsParams {
  ivec4 size;   // width, height of the image; of a finer level's cells; the same for the first
  ivec4 cells;  // columns, rows of this level; level, from 0; w: unused
};

const uint kFootprintBindRaw = 0u;    // two 16-bit depths per word
const uint kFootprintBindOwn = 1u;    // float metres of each pixel, 0 = invalid
const uint kFootprintBindCells = 2u;  // kFootprintLevels bindings: moments
const uint kFootprintBindDepth = 6u;
const uint kFootprintBindPoints = 7u;
const uint kFootprintBindings = 8u;

struct FootprintParams {
  vec4 focal_centre;
  ivec4 size;         // width, height, columns, rows of the first level's cells
  float voxel_size;   // metres
  float noise_floor;  // see lib/depth_noise.glsl
  float noise_growth;
  float min_depth;  // metres; a plane's depth outside of both is none
  float max_depth;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
