#include "tests/reference/footprint.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {

// Relative; single precision, over up to 1024 depths of which each adds a rounding.
constexpr double kSumsError = 2e-5;

/// Least squares q = plane . (1, u - u0, v - v0) over the valid pixels of a square.
struct Fit {
  int pixels = 0;
  double mean_inverse = 0, squares = 0, spread = 0;
  Eigen::Vector2d centre{0, 0};
  Eigen::Vector3d plane{0, 0, 0};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool in_line = true;

  Eigen::Vector3d at(int u, int v) const { return {1, u - centre.x(), v - centre.y()}; }
  double variance(int u, int v) const { return at(u, v).dot(covariance * at(u, v)); }
};

Fit fitOf(const PointImage& own, const Intrinsics& camera, int first_u, int first_v, int side) {
  std::vector<Eigen::Vector3d> rows;  // u, v, q
  for (int v = first_v; v < std::min(first_v + side, camera.height); ++v)
    for (int u = first_u; u < std::min(first_u + side, camera.width); ++u)
      if (const double z = own.depth[std::size_t(v) * camera.width + u]; z > 0)
        rows.emplace_back(u, v, 1 / z);
  Fit fit;
  fit.pixels = static_cast<int>(rows.size());
  if (rows.empty()) return fit;
  Eigen::MatrixX3d a(rows.size(), 3);
  Eigen::VectorXd q(rows.size());
  for (const Eigen::Vector3d& row : rows) fit.centre += row.head<2>() / double(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    a.row(i) << 1, rows[i].x() - fit.centre.x(), rows[i].y() - fit.centre.y();
    q[i] = rows[i].z();
  }
  fit.mean_inverse = q.mean();
  fit.spread = (q.array() - fit.mean_inverse).matrix().squaredNorm();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr(a);
  fit.in_line = qr.rank() < 3;
  if (fit.in_line) return fit;
  fit.plane = qr.solve(q);
  fit.squares = (a * fit.plane - q).squaredNorm();
  fit.covariance = (a.transpose() * a).ldlt().solve(Eigen::Matrix3d::Identity());
  return fit;
}

}  // namespace

PointImage footprint(const PointImage& own, std::span<const std::uint16_t> raw, const Intrinsics& camera,
                     const FootprintOptions& options) {
  PointImage out = own;
  const int least = options.smallest_cell;
  for (int top = 0; top < camera.height; top += least)
    for (int left = 0; left < camera.width; left += least) {
      Fit fit;
      bool flat = false, covered = false, uncertain = false;
      for (int size = options.sizes - 1; size >= 0 && !flat; --size) {
        const int side = least << size;
        fit = fitOf(own, camera, left / side * side, top / side * side, side);
        if (fit.pixels == 0) continue;
        const double voxel = options.voxel_size * camera.fx * fit.mean_inverse;  // pixels
        uncertain |= std::abs(side - voxel) < kSumsError * side;
        covered = side <= voxel;
        if (!(covered || size == 0) || fit.pixels < 4 || fit.in_line) continue;
        const double deviation =
            options.noise.deviation(1 / fit.mean_inverse) * std::pow(fit.mean_inverse, 2);
        const double freedom = fit.pixels - 3;
        const double most = deviation * deviation * (freedom + options.deviations * std::sqrt(2 * freedom));
        uncertain |= std::abs(fit.squares - most) < kSumsError * (fit.spread + most);
        flat = fit.squares <= most;
      }
      for (int v = top; v < std::min(top + least, camera.height); ++v)
        for (int u = left; u < std::min(left + least, camera.width); ++u) {
          const std::size_t i = std::size_t(v) * camera.width + u;
          if (uncertain) out.uncertain[i] = true;
          const bool hole = raw[i] == 0 || raw[i] == 65535;
          if (!flat || !(hole || (own.depth[i] > 0 && covered))) continue;
          const double variance = fit.variance(u, v);
          if (std::abs(variance - options.most_variance) < 1e-3) out.uncertain[i] = true;
          if (variance > options.most_variance) continue;
          const double inverse = fit.plane.dot(fit.at(u, v));
          for (const double limit : {options.min_depth, options.max_depth})
            if (std::abs(inverse * limit - 1) < 1e-5) out.uncertain[i] = true;
          if (!(inverse >= 1 / options.max_depth && inverse <= 1 / options.min_depth)) continue;
          out.depth[i] = 1 / inverse;
          out.points[i] = camera.unproject(u, v, out.depth[i]);
        }
    }
  return out;
}

}  // namespace rosefusion::reference
