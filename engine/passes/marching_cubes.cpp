#include "engine/passes/marching_cubes.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"

namespace rosefusion {
namespace {

int edgeBetween(int a, int b) {
  for (int edge = 0; edge < kCellEdges; ++edge)
    if (edgeStart(edge) == std::min(a, b) && edgeEnd(edge) == std::max(a, b)) return edge;
  throw DeviceError(DeviceErrorCode::Programming, "These corners of a cell share no edge.");
}

/// Corners of a face (axis, and its near or far side) in counter-clockwise order seen from outside the cell.
std::array<int, 4> faceCorners(int axis, int side) {
  const int second = 1 << (axis + 1) % 3, third = 1 << (axis + 2) % 3, base = side << axis;
  if (side == 1) return {base, base | second, base | second | third, base | third};
  return {base, base | third, base | second | third, base | second};
}

bool onCommonFace(int edge_a, int edge_b) {
  const auto faces = [](int edge) {
    const int ones = edgeStart(edge) & edgeEnd(edge), zeros = ~edgeStart(edge) & ~edgeEnd(edge) & 7;
    return ones << 3 | zeros;
  };
  return (faces(edge_a) & faces(edge_b)) != 0;
}

/// next[e]: the crossing that follows edge e's on the surface's boundary, for every crossed edge; -1
/// elsewhere.
std::array<int, kCellEdges> boundaryOf(int cell_case) {
  std::array<int, kCellEdges> next;
  next.fill(-1);
  const auto inside = [&](int corner) { return (cell_case >> corner & 1) != 0; };
  for (int face = 0; face < 6; ++face) {
    const auto corners = faceCorners(face / 2, face % 2);
    for (int i = 0; i < 4; ++i) {
      // A run of inside corners begins behind i: the surface leaves the face where the run ends.
      if (inside(corners[i]) || !inside(corners[(i + 1) % 4])) continue;
      int last = (i + 1) % 4;
      while (inside(corners[(last + 1) % 4])) last = (last + 1) % 4;
      next[edgeBetween(corners[i], corners[(i + 1) % 4])] =
          edgeBetween(corners[last], corners[(last + 1) % 4]);
    }
  }
  return next;
}

/// A fan whose inner edges cross the cell: one that lay in a face could meet the neighbour's, and four
/// triangles would share it.
void addFan(const std::vector<int>& loop, std::vector<CellTriangle>& triangles) {
  const std::size_t n = loop.size();
  for (std::size_t first = 0; first < n; ++first) {
    bool clear = true;
    for (std::size_t i = 2; i + 1 < n; ++i)
      clear = clear && !onCommonFace(loop[first], loop[(first + i) % n]);
    if (!clear) continue;
    for (std::size_t i = 1; i + 1 < n; ++i)
      triangles.push_back({std::uint8_t(loop[first]), std::uint8_t(loop[(first + i) % n]),
                           std::uint8_t(loop[(first + i + 1) % n])});
    return;
  }
  throw DeviceError(DeviceErrorCode::Programming, "A case of marching cubes has no clean fan.");
}

}  // namespace

std::array<std::vector<CellTriangle>, 256> marchingCubesCases() {
  std::array<std::vector<CellTriangle>, 256> cases;
  for (int cell_case = 0; cell_case < 256; ++cell_case) {
    auto next = boundaryOf(cell_case);
    for (int edge = 0; edge < kCellEdges; ++edge) {
      std::vector<int> loop;
      for (int at = edge; next[at] >= 0;) {
        loop.push_back(at);
        at = std::exchange(next[at], -1);
      }
      if (!loop.empty()) addFan(loop, cases[cell_case]);
    }
  }
  return cases;
}

}  // namespace rosefusion
