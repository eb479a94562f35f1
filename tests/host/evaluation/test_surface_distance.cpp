#include "host/evaluation/surface_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "host/evaluation/surface_sampling.h"

namespace rosefusion::testing {
namespace test_surface_distance {

using Eigen::Vector3d;

TEST(ClosestOnTriangle, CoversFaceEdgesAndCorners) {
  const Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_EQ(closestOnTriangle({1, 1, 5}, a, b, c), Vector3d(1, 1, 0));
  EXPECT_EQ(closestOnTriangle({1, -3, 2}, a, b, c), Vector3d(1, 0, 0));
  EXPECT_EQ(closestOnTriangle({-2, 3, -1}, a, b, c), Vector3d(0, 3, 0));
  EXPECT_TRUE(closestOnTriangle({4, 4, 1}, a, b, c).isApprox(Vector3d(2, 2, 0)));
  EXPECT_EQ(closestOnTriangle({-1, -1, 0}, a, b, c), a);
  EXPECT_EQ(closestOnTriangle({9, -1, 3}, a, b, c), b);
  EXPECT_EQ(closestOnTriangle({-1, 9, 3}, a, b, c), c);
  EXPECT_EQ(closestOnTriangle({1, 1, 5}, a, c, b), Vector3d(1, 1, 0)) << "either way round";
}

TEST(ClosestOnTriangle, DegenerateTrianglesAreSegmentsAndPoints) {
  const Vector3d a(0, 0, 0), b(2, 0, 0), c(6, 0, 0);
  EXPECT_EQ(closestOnTriangle({3, 1, 0}, a, b, c), Vector3d(3, 0, 0));
  EXPECT_EQ(closestOnTriangle({3, 1, 0}, b, b, b), b);
}

/// Triangles thrown at random into a room, 10 m wide.
TriangleMesh randomTriangles(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> room(0, 10), size(-0.5f, 0.5f);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Vector3f centre(room(random), room(random), room(random));
    for (int corner = 0; corner < 3; ++corner)
      mesh.vertices.push_back(centre + Eigen::Vector3f(size(random), size(random), size(random)));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

std::vector<Vector3d> randomPoints(std::size_t count) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> room(-5, 15);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(room(random), room(random), room(random));
  return points;
}

TEST(SurfaceDistance, ToTrianglesEqualsTheSearchThroughAll) {
  const TriangleMesh mesh = randomTriangles(300);
  const std::vector<Vector3d> points = randomPoints(500);
  const std::vector<double> found = SurfaceDistance(mesh).to(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : mesh.triangles) {
      const auto corner = [&](int k) -> Vector3d { return mesh.vertices[t[k]].cast<double>(); };
      nearest = std::min(nearest,
                         (closestOnTriangle(points[i], corner(0), corner(1), corner(2)) - points[i]).norm());
    }
    EXPECT_NEAR(found[i], nearest, 1e-9);
  }
}

TEST(SurfaceDistance, ToAPointCloudEqualsTheSearchThroughAll) {
  TriangleMesh cloud = randomTriangles(200);
  cloud.triangles.clear();
  const std::vector<Vector3d> points = randomPoints(500);
  const std::vector<double> found = SurfaceDistance(cloud).to(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3f& v : cloud.vertices)
      nearest = std::min(nearest, (v.cast<double>() - points[i]).norm());
    EXPECT_NEAR(found[i], nearest, 1e-12);
  }
}

TEST(SurfaceDistance, ToNothingIsInfinite) {
  const TriangleMesh nothing;
  EXPECT_EQ(SurfaceDistance(nothing).to({Vector3d(1, 2, 3)}),
            std::vector<double>{std::numeric_limits<double>::infinity()});
}

TEST(SampleSurface, IsUniformByAreaAndOnTheTriangles) {
  // A small and a large triangle, areas 1 : 8, the large one in the plane z = 2.
  const TriangleMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {4, 0, 2}, {0, 2, 2}}, {}, {}, {{0, 1, 2}, {3, 4, 5}}};
  const std::vector<Vector3d> points = sampleSurface(mesh, 90000, 7);
  ASSERT_EQ(points.size(), 90000u);
  std::size_t on_large = 0, outside = 0;
  Vector3d mean_on_large = Vector3d::Zero();
  for (const Vector3d& p : points) {
    const bool large = p.z() > 1;
    const double beyond = large ? p.x() / 4 + p.y() / 2 : p.x() + p.y();
    if (std::abs(p.z() - (large ? 2 : 0)) > 1e-12 || beyond > 1 + 1e-12 || p.x() < 0 || p.y() < 0) ++outside;
    if (!large) continue;
    ++on_large;
    mean_on_large += p;
  }
  EXPECT_EQ(outside, 0u);
  // Binomial: sigma = sqrt(90000 * 8/81) = 94.
  EXPECT_NEAR(static_cast<double>(on_large), 80000, 400);
  mean_on_large /= static_cast<double>(on_large);
  EXPECT_NEAR(mean_on_large.x(), 4.0 / 3, 0.02) << "the centroid: uniform inside, too";
  EXPECT_NEAR(mean_on_large.y(), 2.0 / 3, 0.01);
}

TEST(SampleSurface, DependsOnTheSeedAlone) {
  const TriangleMesh mesh = randomTriangles(20);
  EXPECT_EQ(sampleSurface(mesh, 100, 1), sampleSurface(mesh, 100, 1));
  EXPECT_NE(sampleSurface(mesh, 100, 1), sampleSurface(mesh, 100, 2));
}

TEST(SampleSurface, OfAPointCloudAreItsPoints) {
  TriangleMesh cloud = randomTriangles(10);
  cloud.triangles.clear();
  EXPECT_EQ(sampleSurface(cloud, 1000, 1).size(), 30u);
  EXPECT_EQ(sampleSurface(cloud, 20, 1).size(), 20u);
}

}  // namespace test_surface_distance
}  // namespace rosefusion::testing
