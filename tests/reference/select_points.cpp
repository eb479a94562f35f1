#include "tests/reference/select_points.h"

#include <cmath>

namespace rosefusion::reference {
Selection selectPoints(const PointImage& image, const Intrinsics& camera, int stride, int offset_x,
                       int offset_y, const Pose* previous_from_current) {
  Selection selection;
  for (int v = offset_y; v < camera.height; v += stride)
    for (int u = offset_x; u < camera.width; u += stride) {
      const std::size_t pixel = std::size_t(v) * camera.width + u;
      if (image.depth[pixel] <= 0) continue;
      ++selection.valid;
      const Eigen::Vector3d& point = image.points[pixel];
      if (!previous_from_current) {
        selection.points.push_back({point});
        continue;
      }
      const Eigen::Vector3d moved = *previous_from_current * point;
      if (moved.z() < -kPositionError) continue;
      const Eigen::Vector2d uv = camera.project(moved);
      // How far inside the image's outline, which runs half a pixel around the outer pixel centres.
      const double margin =
          std::min({uv.x() + 0.5, uv.y() + 0.5, camera.width - 0.5 - uv.x(), camera.height - 0.5 - uv.y()});
      const double error =
          3 * std::abs(camera.fx) * kPositionError * moved.norm() / (moved.z() * moved.z()) + 1e-4;
      if (margin > -error || moved.z() < kPositionError)
        selection.points.push_back({point, margin > error && moved.z() > kPositionError});
    }
  return selection;
}

Comparison compare(const Selection& expected, std::span<const float> selected) {
  Comparison result;
  std::size_t next = 0;
  const std::size_t count = selected.size() / 4;
  for (std::size_t i = 0; i < expected.points.size(); ++i) {
    const auto& [point, certain] = expected.points[i];
    const Eigen::Vector3d got =
        next < count ? Eigen::Vector3d(selected[4 * next], selected[4 * next + 1], selected[4 * next + 2])
                     : Eigen::Vector3d::Constant(INFINITY);
    const double error = (got - point).norm() / (kPointTolerance * point.norm());
    if (!certain) {
      ++result.skipped;
      if (error <= 1) ++next;
      continue;
    }
    result.add(error, "point " + std::to_string(i) + " is missing or out of order");
    ++next;
    if (error > 1) return result;  // all that follow would be out of step
  }
  if (next != count) result.add(INFINITY, std::to_string(count - next) + " points too many");
  return result;
}

}  // namespace rosefusion::reference
