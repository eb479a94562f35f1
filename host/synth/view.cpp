#include "host/synth/view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

namespace rosefusion {

double ViewQuality::score() const {
  return 2 * valid - 2 * near + 6 * std::min(constraint, 0.08) - 2 * std::max(0.0, 0.9 - median);
}

ViewQuality judgeView(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                      double max_depth) {
  constexpr int kColumns = 12, kRows = 9;
  const Eigen::Matrix3d rotation = world_from_camera.linear();
  std::vector<double> depths;
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  int near = 0;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double u = (column + 0.5) / kColumns * intrinsics.width - 0.5;
      const double v = (row + 0.5) / kRows * intrinsics.height - 0.5;
      const auto hit =
          tracer.cast(world_from_camera.translation(), rotation * intrinsics.unproject(u, v, 1), max_depth);
      if (!hit) continue;
      depths.push_back(hit->distance);
      near += hit->distance < 0.4;
      normals += hit->normal * hit->normal.transpose();
    }
  ViewQuality quality;
  if (depths.empty()) return quality;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  quality.valid = double(depths.size()) / (kColumns * kRows);
  quality.near = double(near) / (kColumns * kRows);
  quality.median = *middle;
  quality.constraint =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normals / double(depths.size())).eigenvalues()[0];
  return quality;
}

}  // namespace rosefusion
