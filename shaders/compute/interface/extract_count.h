// Pass extract_count: how many vertices and triangles each block's part of the surface has.
#ifndef ROSEFUSION_INTERFACE_EXTRACT_COUNT_H
#define ROSEFUSION_INTERFACE_EXTRACT_COUNT_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kExtractGroup = 64u;  // one workgroup per block; an invocation owns a row of 8 voxels along x
const uint kCaseTriangles = 5u;  // at most, of a cell
const uint kCaseWords =
    6u;  // of a case in the table: number of triangles, then each one's three edges, 4 bits each
const uint kCases = 256u;
const uint kExtractCountBindLayout = 0u;
const uint kExtractCountBindTable = 1u;
const uint kExtractCountBindBlocks = 2u;  // ivec4 block coordinate per slot
const uint kExtractCountBindTsdf = 3u;    // kMaxPoolChunks bindings
const uint kExtractCountBindWeight = 7u;
const uint kExtractCountBindCases = 11u;
const uint kExtractCountBindCounts = 12u;  // ExtractCount per block, from first_slot on
const uint kExtractCountBindings = 13u;

struct ExtractCountParams {
  uint first_slot;
  uint blocks;
  float min_weight;  // observations below which a voxel counts as unobserved
  uint pad0;
};

struct ExtractCount {
  uint vertices;
  uint triangles;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
