// A block with its surroundings in shared memory, and its marching cubes. The includer defines EXTRACT_BEFORE (voxels
// needed before the block's first), EXTRACT_SIDE (voxels per axis in all) and EXTRACT_CASES (the binding of the table of
// cases).
#include "shaders/compute/interface/extract_count.h"
#extension GL_EXT_control_flow_attributes : require

READ_WORDS(caseWord, EXTRACT_CASES)

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

// The voxels that decide about the row of 8 cells that an invocation owns: the row's and those beside it, x from 0 to 8 as
// bits. Rows in the order (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1).
struct Rows {
  uint negative[4];
  uint observed[4];
};

ivec3 rowStart(uint lane) { return ivec3(0, lane & 7u, lane >> 3); }

Rows rowsOf(uint lane) {
  ivec3 start = rowStart(lane);
  Rows rows;
  [[unroll]] for (int r = 0; r < 4; ++r) {
    rows.negative[r] = rows.observed[r] = 0u;
    [[unroll]] for (int x = 0; x <= kBlockSide; ++x) {
      float value = valueAt(start + ivec3(x, r & 1, r >> 1));
      rows.negative[r] |= uint(value < 0.0) << x;
      rows.observed[r] |= uint(value < kNotObserved) << x;
    }
  }
  return rows;
}

// Which of the row's edges along x, y and z the surface crosses, x from 0 to 7 as bits.
uvec3 crossedEdges(Rows rows) {
  uint n = rows.negative[0], o = rows.observed[0];
  return 0xFFu & uvec3((n ^ n >> 1) & o & o >> 1, (n ^ rows.negative[1]) & o & rows.observed[1],
                       (n ^ rows.negative[2]) & o & rows.observed[2]);
}

// Which of the row's cells hold a part of the surface.
uint crossedCells(Rows rows) {
  uint all = 0x1FFu, any = 0u, observed = 0x1FFu;
  [[unroll]] for (int r = 0; r < 4; ++r) {
    all &= rows.negative[r];
    any |= rows.negative[r];
    observed &= rows.observed[r];
  }
  return 0xFFu & observed & observed >> 1 & (any | any >> 1) & ~(all & all >> 1);
}

// Case of the row's cell x: its corners' signs, x fastest.
uint caseOf(Rows rows, uint x) {
  uint cell_case = 0u;
  [[unroll]] for (uint r = 0u; r < 4u; ++r) cell_case |= (rows.negative[r] >> x & 3u) << (2u * r);
  return cell_case;
}

// How many triangles those cells of the row have together.
uint trianglesOf(Rows rows, uint cells) {
  uint triangles = 0u;
  if (cells != 0u) do {
    triangles += caseWord(caseOf(rows, uint(findLSB(cells))) * kCaseWords);
    cells &= cells - 1u;
  } while (cells != 0u);
  return triangles;
}
