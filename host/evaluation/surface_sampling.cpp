#include "host/evaluation/surface_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace rosefusion {
namespace {

/// Uniform in [0, 1): std::uniform_real_distribution differs between standard libraries.
double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

Eigen::Vector3d vertex(const TriangleMesh& mesh, std::size_t index) {
  return mesh.vertices[index].cast<double>();
}

}  // namespace

std::vector<Eigen::Vector3d> sampleSurface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Eigen::Vector3d> points;
  if (mesh.triangles.empty()) {
    const std::size_t n = mesh.vertices.size();
    for (std::size_t i = 0; i < std::min(n, count); ++i) {
      const std::size_t drawn =
          n <= count ? i : static_cast<std::size_t>(uniform(random) * static_cast<double>(n));
      points.push_back(vertex(mesh, drawn));
    }
    return points;
  }
  std::vector<double> area_up_to;
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = vertex(mesh, t[0]);
    total += (vertex(mesh, t[1]) - a).cross(vertex(mesh, t[2]) - a).norm() / 2;
    area_up_to.push_back(total);
  }
  if (!(total > 0)) return points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = std::upper_bound(area_up_to.begin(), area_up_to.end(), uniform(random) * total);
    const std::size_t index =
        std::min(static_cast<std::size_t>(at - area_up_to.begin()), area_up_to.size() - 1);
    const auto& t = mesh.triangles[index];
    // Uniform in the triangle: the square root makes up for its narrowing towards corner 0.
    const double along = std::sqrt(uniform(random)), across = uniform(random);
    points.push_back((1 - along) * vertex(mesh, t[0]) + along * (1 - across) * vertex(mesh, t[1]) +
                     along * across * vertex(mesh, t[2]));
  }
  return points;
}

}  // namespace rosefusion
