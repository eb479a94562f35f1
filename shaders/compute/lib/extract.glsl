// A block with its surroundings in shared memory, and its marching cubes. The includer defines EXTRACT_BEFORE (voxels
// needed before the block's first) and EXTRACT_SIDE (voxels per axis in all).
#include "shaders/compute/interface/extract_count.h"

const float kNotObserved = 2.0;  // stands for a voxel without a TSDF value

shared uint s_slots[27];  // of the blocks around
shared float s_tsdf[EXTRACT_SIDE * EXTRACT_SIDE * EXTRACT_SIDE];

// `offset` in blocks, -1 .. 1 per axis.
uint slotBeside(ivec3 offset) { return s_slots[(offset.z * 3 + offset.y) * 3 + offset.x + 13]; }

// TSDF of a voxel counted from the block's first.
float valueAt(ivec3 voxel) {
  ivec3 v = voxel + EXTRACT_BEFORE;
  return s_tsdf[(v.z * EXTRACT_SIDE + v.y) * EXTRACT_SIDE + v.x];
}

void loadSurroundings(ivec3 block, uint lane, float min_weight) {
  if (lane < 27u) {
    ivec3 offset = ivec3(lane % 3u, lane / 3u % 3u, lane / 9u) - 1;
    s_slots[lane] = slotAt(clampToTable(block + offset - volume.table_origin.xyz));
  }
  barrier();
  const uint kSide = uint(EXTRACT_SIDE);
  for (uint i = lane; i < kSide * kSide * kSide; i += kExtractGroup) {
    ivec3 voxel = ivec3(i % kSide, i / kSide % kSide, i / (kSide * kSide)) - EXTRACT_BEFORE;
    uint slot = slotBeside(voxel >> 3), local = localIndex(voxel);
    float weight = weightInBlock(slot, local);
    s_tsdf[i] = weight > 0.0 && weight >= min_weight ? tsdfInBlock(slot, local) : kNotObserved;
  }
  barrier();
}

ivec3 axisStep(int axis) { return ivec3(axis == 0, axis == 1, axis == 2); }

bool crosses(float a, float b) { return max(a, b) < kNotObserved && (a < 0.0) != (b < 0.0); }

// Case of the cell whose first corner is `voxel`; 0, which has no triangles, where a corner was not observed.
uint caseAt(ivec3 voxel) {
  uint cell_case = 0u;
  bool observed = true;
  for (int corner = 0; corner < 8; ++corner) {
    float value = valueAt(voxel + (ivec3(corner) >> ivec3(0, 1, 2) & 1));
    observed = observed && value < kNotObserved;
    cell_case |= value < 0.0 ? 1u << corner : 0u;
  }
  return observed ? cell_case : 0u;
}

// The row of voxels along x that an invocation owns begins here.
ivec3 rowStart(uint lane) { return ivec3(0, lane & 7u, lane >> 3); }
