// Mesh extraction against its reference, against the true surface, and the host's welding and clean-up.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>

#include "host/slam/mapping/mesh_extraction.h"
#include "tests/engine/surface_scene.h"
#include "tests/reference/extract.h"

namespace rosefusion::testing {
namespace test_extract {

using Eigen::Vector3d;
using reference::GridEdge;
using reference::Segment;

// Single-precision coordinates a few metres from the origin, in voxels of a centimetre or two.
constexpr double kPositionToleranceVoxels = 1e-4;
// Single-precision differences of values that are stored in steps of 1/32767.
constexpr double kNormalTolerance = 1e-3;
// A vertex keeps 1e-3 of its edge free at both ends; nearer to a grid line it lies on that line.
constexpr double kOnLineVoxels = 5e-4;

/// The grid edge that a vertex lies on; none when it lies on no single one.
std::optional<GridEdge> edgeOf(const Eigen::Vector3f& vertex, double voxel_size) {
  const Vector3d p = vertex.cast<double>() / voxel_size - Vector3d::Constant(0.5);
  GridEdge edge{0, 0, 0, -1};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(p[axis] - std::round(p[axis])) < kOnLineVoxels) {
      edge[axis] = int(std::round(p[axis]));
      continue;
    }
    if (edge[3] >= 0) return std::nullopt;
    edge[axis] = int(std::floor(p[axis]));
    edge[3] = axis;
  }
  if (edge[3] < 0) return std::nullopt;
  return edge;
}

/// What differs between a mesh and the reference, counted.
struct Differences {
  std::size_t vertices =
      0;  ///< on no edge of the grid, double, not in the reference, or elsewhere than there
  std::size_t normals = 0;
  std::size_t missing = 0;  ///< points of the reference
  std::size_t sides =
      0;  ///< triangle sides not met by as many triangles, in the right directions, as they should
  std::size_t segments = 0;  ///< of the reference, without triangle
  std::size_t total() const { return vertices + normals + missing + sides + segments; }
};

Differences compare(const TriangleMesh& mesh, const reference::Surface& surface, double voxel_size) {
  Differences found;
  std::vector<GridEdge> edges;
  std::set<GridEdge> seen;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto edge = edgeOf(mesh.vertices[i], voxel_size);
    const auto point = edge ? surface.points.find(*edge) : surface.points.end();
    edges.push_back(edge.value_or(GridEdge{0, 0, 0, -1}));
    if (point == surface.points.end() || !seen.insert(*edge).second) {
      ++found.vertices;
      continue;
    }
    const double off = (mesh.vertices[i].cast<double>() - point->second.position).norm();
    found.vertices += off > kPositionToleranceVoxels * voxel_size;
    found.normals += (mesh.normals[i].cast<double>() - point->second.normal).norm() > kNormalTolerance;
  }
  for (const auto& [edge, point] : surface.points) found.missing += !seen.contains(edge);

  std::map<Segment, std::pair<int, int>> sides;  // triangles that run along them forwards, backwards
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const GridEdge &a = edges[t[i]], &b = edges[t[(i + 1) % 3]];
      ++(a < b ? sides[{a, b}].first : sides[{b, a}].second);
    }
  for (const auto& [side, count] : sides) {
    const auto segment = surface.segments.find(side);
    const bool open = segment != surface.segments.end() && segment->second == 1;
    found.sides += open ? count.first + count.second != 1 : count != std::pair(1, 1);
  }
  for (const auto& [segment, cells] : surface.segments) found.segments += !sides.contains(segment);
  return found;
}

void expectNone(const Differences& found) {
  EXPECT_EQ(found.vertices, 0u);
  EXPECT_EQ(found.normals, 0u);
  EXPECT_EQ(found.missing, 0u);
  EXPECT_EQ(found.sides, 0u);
  EXPECT_EQ(found.segments, 0u);
}

class Extract : public SurfaceTest {
 protected:
  SurfaceScene& scene(const SceneOptions& options = {}) {
    if (!scene_) {
      scene_.emplace(device, options);
      for (const auto& pose : posesAllAround()) scene_->fuse(pose);
    }
    return *scene_;
  }
  TriangleMesh extract(const MeshOptions& options = {}) {
    ExtractPass pass(device);
    return extractMesh(pass, scene().volume, options);
  }

 private:
  std::optional<SurfaceScene> scene_;
};

TEST_F(Extract, AgreesWithTheReference) {
  for (const float min_weight : {1.0f, 4.0f}) {
    const auto field = scene().field();
    const auto surface = reference::extractSurface(field, min_weight);
    ASSERT_GT(surface.points.size(), 50000u);
    expectNone(compare(extract({.min_weight = min_weight}), surface, field.voxelSize()));
  }
}

TEST_F(Extract, AgreementIsLostWhenACoefficientIsWrong) {
  const TriangleMesh mesh = extract();
  const auto field = scene().field();
  const double voxel = field.voxelSize();
  const auto surface = reference::extractSurface(field, 1);
  const auto share = [&](const Differences& found) { return double(found.total()) / mesh.vertices.size(); };
  EXPECT_GT(share(compare(mesh, reference::extractSurface(scene().field(1.01), 1), voxel)), 0.5)
      << "voxel size";
  EXPECT_GT(share(compare(mesh, reference::extractSurface(field, 2), voxel)), 0.01) << "minimum weight";
  TriangleMesh shifted = mesh;
  for (auto& vertex : shifted.vertices) vertex.x() += float(2e-4 * voxel);
  EXPECT_GT(compare(shifted, surface, voxel).vertices, mesh.vertices.size() / 2) << "a shift";
  TriangleMesh inverted = mesh;
  for (auto& normal : inverted.normals) normal = -normal;
  EXPECT_EQ(compare(inverted, surface, voxel).normals, mesh.vertices.size()) << "normals inwards";
  TriangleMesh cracked = mesh;
  cracked.triangles.erase(cracked.triangles.begin() + 1000);
  EXPECT_GT(compare(cracked, surface, voxel).total(), 0u) << "a missing triangle";
  TriangleMesh flipped = mesh;
  std::swap(flipped.triangles[1000][0], flipped.triangles[1000][1]);
  EXPECT_GT(compare(flipped, surface, voxel).total(), 0u) << "a triangle turned over";
}

TEST_F(Extract, BatchesMeetWithoutCracks) {
  const auto field = scene({.voxel_size = 0.015f}).field();
  ExtractPass pass(device);
  std::size_t batches = 0;
  pass.run(scene().volume, 1, [&](const ExtractBatch&) { ++batches; });
  EXPECT_GT(batches, 1u);
  expectNone(compare(extract(), reference::extractSurface(field, 1), field.voxelSize()));
}

TEST_F(Extract, TheSphereIsClosedAndTrue) {
  const TriangleMesh mesh = extract();
  const double voxel = scene().volume.options().voxel_size;
  const auto onSphere = [&](std::uint32_t v) { return mesh.vertices[v].norm() < 2 * kSphereRadius; };
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  std::set<std::uint32_t> vertices;
  std::size_t triangles = 0, outwards = 0;
  for (const auto& t : mesh.triangles) {
    if (!onSphere(t[0])) continue;
    ++triangles;
    const Eigen::Vector3f a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    outwards += (b - a).cross(c - a).dot(a) > 0;
    for (int i = 0; i < 3; ++i) {
      vertices.insert(t[i]);
      ++sides[{t[i], t[(i + 1) % 3]}];
    }
  }
  ASSERT_GT(triangles, 10000u);
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(sides.contains({side.second, side.first}));
  }
  // A closed surface without handles.
  EXPECT_EQ(vertices.size() + triangles, sides.size() / 2 + 2);
  EXPECT_EQ(outwards, triangles);
  for (const std::uint32_t v : vertices) {
    EXPECT_LT(std::abs(mesh.vertices[v].norm() - kSphereRadius), 0.5 * voxel);
    EXPECT_GT(mesh.normals[v].dot(mesh.vertices[v].normalized()), 0);
  }
}

TEST_F(Extract, RepeatsExactly) {
  const TriangleMesh first = extract(), second = extract();
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.normals, second.normals);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST_F(Extract, TakesTheVolumesColours) {
  scene({.colour = true});
  const TriangleMesh mesh = extract();
  ASSERT_EQ(mesh.colours.size(), mesh.vertices.size());
  std::size_t right = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::uint32_t expected = mesh.vertices[i].norm() < 2 * kSphereRadius ? kSphereColour : kBoxColour;
    bool same = true;
    for (int c = 0; c < 3; ++c)
      same = same && std::abs(int(expected >> 8 * c & 255) - mesh.colours[i][c]) <= 2;
    right += same;
  }
  // Pixels on the sphere's outline paint a few voxels of the box behind it.
  EXPECT_GT(right, mesh.vertices.size() * 98 / 100);
}

TEST_F(Extract, WithoutColourTheMeshHasNone) {
  EXPECT_TRUE(extract().colours.empty());
}

TEST_F(Extract, AnEmptyVolumeGivesAnEmptyMesh) {
  SurfaceScene empty(device, {});
  ExtractPass pass(device);
  const TriangleMesh mesh = extractMesh(pass, empty.volume);
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

/// Two triangles with a common side, one apart, and a vertex without triangle.
TriangleMesh threeTriangles() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(float(i), 0, 0);
    mesh.normals.emplace_back(0, float(i), 0);
    mesh.colours.push_back({std::uint8_t(i), 0, 0});
  }
  mesh.triangles = {{7, 6, 5}, {1, 2, 3}, {3, 2, 4}};
  return mesh;
}

TEST(MeshCleanUp, DropsUnusedVertices) {
  TriangleMesh mesh = threeTriangles();
  dropUnusedVertices(mesh);
  ASSERT_EQ(mesh.vertices.size(), 7u);
  EXPECT_EQ(mesh.vertices[0].x(), 1);
  EXPECT_EQ(mesh.normals[6].y(), 7);
  EXPECT_EQ(mesh.colours[3][0], 4);
  EXPECT_EQ(mesh.triangles, (decltype(mesh.triangles){{6, 5, 4}, {0, 1, 2}, {2, 1, 3}}));
}

TEST(MeshCleanUp, DropsSmallComponents) {
  TriangleMesh mesh = threeTriangles();
  dropSmallComponents(mesh, 2);
  ASSERT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.vertices[3].x(), 4);
  EXPECT_EQ(mesh.triangles, (decltype(mesh.triangles){{0, 1, 2}, {2, 1, 3}}));
  dropSmallComponents(mesh, 3);
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST_F(Extract, SmallComponentsGoOnRequest) {
  const TriangleMesh all = extract(), large = extract({.min_component_triangles = 30000});
  const auto near = [](const TriangleMesh& mesh) {
    return std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                         [](const auto& v) { return v.norm() < 2 * kSphereRadius; });
  };
  EXPECT_GT(near(all), 0);
  EXPECT_EQ(near(large), 0);
  EXPECT_GT(large.triangles.size(), 50000u);
}

}  // namespace test_extract
}  // namespace rosefusion::testing
