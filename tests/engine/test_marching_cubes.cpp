// The generated cases of marching cubes: every case by itself, and many cells together.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "engine/passes/marching_cubes.h"

namespace rosefusion::testing {
namespace test_marching_cubes {

using Corner = std::array<int, 3>;

Corner cornerAt(int corner) {
  return {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

/// Directed boundary of a case's triangles: edges of triangles that no other triangle of the case runs
/// backwards.
std::set<std::pair<int, int>> boundary(const std::vector<CellTriangle>& triangles) {
  std::set<std::pair<int, int>> open;
  for (const CellTriangle& t : triangles)
    for (int i = 0; i < 3; ++i)
      if (open.erase({t[(i + 1) % 3], t[i]}) == 0) open.insert({t[i], t[(i + 1) % 3]});
  return open;
}

bool onFace(int edge, int axis, int side) {
  return cornerAt(edgeStart(edge))[axis] == side && cornerAt(edgeEnd(edge))[axis] == side;
}

bool shareFace(int a, int b) {
  for (int face = 0; face < 6; ++face)
    if (onFace(a, face / 2, face % 2) && onFace(b, face / 2, face % 2)) return true;
  return false;
}

TEST(MarchingCubes, EdgesDifferAndJoinNeighbours) {
  std::set<std::pair<int, int>> seen;
  for (int edge = 0; edge < kCellEdges; ++edge) {
    const Corner a = cornerAt(edgeStart(edge)), b = cornerAt(edgeEnd(edge));
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(b[axis] - a[axis], axis == edgeAxis(edge) ? 1 : 0);
    EXPECT_TRUE(seen.insert({edgeStart(edge), edgeEnd(edge)}).second);
  }
}

TEST(MarchingCubes, EveryCaseUsesItsCrossedEdges) {
  const auto cases = marchingCubesCases();
  for (int c = 0; c < 256; ++c) {
    std::set<int> crossed, used;
    for (int edge = 0; edge < kCellEdges; ++edge)
      if ((c >> edgeStart(edge) & 1) != (c >> edgeEnd(edge) & 1)) crossed.insert(edge);
    for (const CellTriangle& t : cases[c]) used.insert(t.begin(), t.end());
    EXPECT_EQ(used, crossed) << "case " << c;
    EXPECT_LE(cases[c].size(), 5u) << "case " << c;

    // A closed outline: one segment in and one out at every crossing, each within a face.
    std::multiset<int> from, to;
    for (const auto& [a, b] : boundary(cases[c])) {
      from.insert(a);
      to.insert(b);
      EXPECT_TRUE(shareFace(a, b)) << "case " << c;
    }
    EXPECT_EQ(from, std::multiset<int>(crossed.begin(), crossed.end())) << "case " << c;
    EXPECT_EQ(to, from) << "case " << c;
  }
}

TEST(MarchingCubes, InnerEdgesStayOffTheFaces) {
  const auto cases = marchingCubesCases();
  for (int c = 0; c < 256; ++c) {
    const auto outline = boundary(cases[c]);
    for (const CellTriangle& t : cases[c])
      for (int i = 0; i < 3; ++i) {
        const std::pair side{int(t[i]), int(t[(i + 1) % 3])};
        EXPECT_TRUE(outline.contains(side) || !shareFace(side.first, side.second)) << "case " << c;
      }
  }
}

TEST(MarchingCubes, TrianglesFaceTheOutside) {
  // One inside corner: the triangle's counter-clockwise normal points away from it.
  const auto cases = marchingCubesCases();
  for (int corner = 0; corner < kCellCorners; ++corner) {
    const auto& triangles = cases[1 << corner];
    ASSERT_EQ(triangles.size(), 1u);
    std::array<std::array<double, 3>, 3> p;
    for (int i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis)
        p[i][axis] =
            0.5 * (cornerAt(edgeStart(triangles[0][i]))[axis] + cornerAt(edgeEnd(triangles[0][i]))[axis]);
    for (int axis = 0; axis < 3; ++axis) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      const double normal =
          (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
      EXPECT_GT(normal * (cornerAt(corner)[axis] == 0 ? 1 : -1), 0) << "corner " << corner;
    }
  }
}

TEST(MarchingCubes, RandomVolumesGiveClosedOrientedManifolds) {
  constexpr int kSide = 12;
  const auto cases = marchingCubesCases();
  std::mt19937 random(7);
  for (const double density : {0.1, 0.35, 0.5, 0.8}) {
    std::bernoulli_distribution inside(density);
    // A shell of outside voxels closes the surface.
    std::array<std::array<std::array<bool, kSide>, kSide>, kSide> voxels{};
    for (int z = 1; z + 1 < kSide; ++z)
      for (int y = 1; y + 1 < kSide; ++y)
        for (int x = 1; x + 1 < kSide; ++x) voxels[z][y][x] = inside(random);
    using Vertex = std::array<int, 4>;  // voxel and axis
    std::map<std::pair<Vertex, Vertex>, int> sides;
    for (int z = 0; z + 1 < kSide; ++z)
      for (int y = 0; y + 1 < kSide; ++y)
        for (int x = 0; x + 1 < kSide; ++x) {
          int c = 0;
          for (int i = 0; i < kCellCorners; ++i)
            if (voxels[z + cornerAt(i)[2]][y + cornerAt(i)[1]][x + cornerAt(i)[0]]) c |= 1 << i;
          for (const CellTriangle& t : cases[c]) {
            std::array<Vertex, 3> v;
            for (int i = 0; i < 3; ++i) {
              const Corner start = cornerAt(edgeStart(t[i]));
              v[i] = {x + start[0], y + start[1], z + start[2], edgeAxis(t[i])};
            }
            for (int i = 0; i < 3; ++i) ++sides[{v[i], v[(i + 1) % 3]}];
          }
        }
    ASSERT_GT(sides.size(), 100u);
    for (const auto& [side, count] : sides) {
      ASSERT_EQ(count, 1) << "density " << density;
      ASSERT_TRUE(sides.contains({side.second, side.first})) << "density " << density;
    }
  }
}

}  // namespace test_marching_cubes
}  // namespace rosefusion::testing
