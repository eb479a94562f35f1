// The triangles of marching cubes' 256 cases, made from a rule instead of a table.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace rosefusion {

/// A cell's corners and edges as numbers. Corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge e runs along
/// axis e / 4 from corner `edgeStart(e)`.
inline constexpr int kCellCorners = 8;
inline constexpr int kCellEdges = 12;
constexpr int edgeAxis(int edge) {
  return edge / 4;
}
constexpr int edgeStart(int edge) {
  const int axis = edgeAxis(edge), second = (axis + 1) % 3, third = (axis + 2) % 3;
  return (edge & 1) << second | (edge >> 1 & 1) << third;
}
constexpr int edgeEnd(int edge) {
  return edgeStart(edge) | 1 << edgeAxis(edge);
}

using CellTriangle = std::array<std::uint8_t, 3>;  ///< the edges its corners lie on

/// Triangles per case; bit c of a case is set where corner c is inside (negative). Counter-clockwise seen
/// from the positive side. After Lorensen and Cline 1987; ambiguous faces keep their two inside corners
/// apart, which depends on nothing but the face's signs, so that the surfaces of neighbouring cells always
/// meet.
std::array<std::vector<CellTriangle>, 256> marchingCubesCases();

}  // namespace rosefusion
