// Exact distance from points to a triangle mesh or a point cloud.
#pragma once
#include <memory>
#include <vector>

#include "host/core/mesh.h"

namespace rosefusion {

/// Triangles are searched by Embree's point queries, point clouds (meshes without triangles) by nanoflann's
/// KD-tree.
class SurfaceDistance {
 public:
  /// Keeps a reference to `mesh`, which must have vertices, all finite, and triangles that name existing
  /// ones.
  explicit SurfaceDistance(const TriangleMesh& mesh);
  ~SurfaceDistance();
  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;

  /// Distance of each point to the nearest point of the surface, metres; float precision (1e-6 of the
  /// coordinates).
  std::vector<double> to(const std::vector<Eigen::Vector3d>& points) const;

  struct Search;

 private:
  std::unique_ptr<Search> search_;
};

/// The point of triangle (a, b, c) nearest to p. Degenerate triangles are segments or points.
Eigen::Vector3d closestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace rosefusion
