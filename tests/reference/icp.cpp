#include "tests/reference/icp.h"

#include <cmath>
#include <optional>

namespace rosefusion::reference {
namespace {

using IcpSums = Eigen::Matrix<double, kIcpSums, 1>;

// Single precision moves a projection by less than this (coordinates up to 161 px, some ten operations), and
// the quantities of the gates by less than that.
constexpr double kPixelError = 2e-4;
constexpr double kGateError = 2e-5;

std::optional<Eigen::Vector3d> normalAt(const IcpModel& model, std::span<const Eigen::Vector4d> points,
                                        int column, int row, double slack) {
  const auto neighbour = [&](int dx, int dy) -> Eigen::Vector4d {
    const int x = column + dx, y = row + dy;
    if (x < 0 || y < 0 || x >= model.camera.width || y >= model.camera.height) return Eigen::Vector4d::Zero();
    return points[static_cast<std::size_t>(y) * model.camera.width + x];
  };
  const Eigen::Vector3d own = neighbour(0, 0).head<3>();
  Eigen::Vector4d around[4] = {neighbour(-model.reach, 0), neighbour(model.reach, 0),
                               neighbour(0, -model.reach), neighbour(0, model.reach)};
  for (const Eigen::Vector4d& q : around)
    if (q.w() == 0 || (q.head<3>() - own).norm() > model.distance + slack) return std::nullopt;
  const Eigen::Vector3d x = (around[1] - around[0]).head<3>(), y = (around[3] - around[2]).head<3>();
  const Eigen::Vector3d n = x.cross(y).normalized();
  return n.dot(own) > 0 ? Eigen::Vector3d(-n) : n;
}

/// What the pixel adds, with its projection moved by `moved` pixels and gates wider by `slack`.
IcpSums terms(const IcpModel& model, std::span<const Eigen::Vector4d> points, const Pose& world_from_camera,
              int column, int row, const Eigen::Vector2d& moved, double slack, IcpSums* size) {
  IcpSums out = IcpSums::Zero();
  const Eigen::Vector4d p = points[static_cast<std::size_t>(row) * model.camera.width + column];
  if (p.w() == 0) return out;
  const Eigen::Vector3d point = world_from_camera * Eigen::Vector3d(p.head<3>());
  const Eigen::Vector3d arm = point - world_from_camera.translation();
  const Eigen::Vector3d seen = model.world_from_camera.inverse() * point;
  if (seen.z() <= 0) return out;
  const Eigen::Vector2d image = model.camera.project(seen) + moved;
  const int u = static_cast<int>(std::floor(image.x() + 0.5)),
            v = static_cast<int>(std::floor(image.y() + 0.5));
  if (u < 0 || v < 0 || u >= model.camera.width || v >= model.camera.height) return out;
  const std::size_t pixel = static_cast<std::size_t>(v) * model.camera.width + u;
  const double depth = model.surface[pixel].w();
  if (depth == 0) return out;
  const Eigen::Vector3d ray((u - model.camera.cx) / model.camera.fx, (v - model.camera.cy) / model.camera.fy,
                            1);
  const Eigen::Vector3d off = point - model.world_from_camera * Eigen::Vector3d(depth * ray),
                        n = model.surface[pixel].head<3>();
  const auto own = normalAt(model, points, column, row, slack);
  if (off.norm() > model.distance + slack || !own ||
      (world_from_camera.linear() * *own).dot(n) < model.cosine - slack)
    return out;
  Eigen::Matrix<double, 6, 1> jacobian, length;
  jacobian << n, model.turn_sense * arm.cross(n);
  length << 1, 1, 1, Eigen::Vector3d::Constant(arm.norm());
  const double residual = n.dot(off);
  IcpSums bound = IcpSums::Zero();
  int entry = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j, ++entry) {
      out[entry] = jacobian[i] * jacobian[j];
      bound[entry] = length[i] * length[j];
    }
  // The residual's rounding is that of positions of some metres.
  out.segment<6>(21) = jacobian * residual;
  bound.segment<6>(21) = length * (std::abs(residual) + 0.3);
  out[27] = residual * residual;
  bound[27] = residual * residual + 0.3 * std::abs(residual);
  out[28] = bound[28] = 1;
  if (size) *size = bound;
  return out;
}

}  // namespace

std::vector<SumRange> icpSums(const IcpModel& model, std::span<const Eigen::Vector4d> points,
                              const Pose& world_from_camera) {
  std::vector<SumRange> sums(kIcpSums);
  for (int row = model.offset; row < model.camera.height; row += model.stride)
    for (int column = model.offset; column < model.camera.width; column += model.stride) {
      IcpSums size = IcpSums::Zero();
      IcpSums low = terms(model, points, world_from_camera, column, row, Eigen::Vector2d::Zero(), 0, &size),
              high = low;
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector2d moved(i & 1 ? kPixelError : -kPixelError, i & 2 ? kPixelError : -kPixelError);
        IcpSums own_size = IcpSums::Zero();
        const IcpSums at = terms(model, points, world_from_camera, column, row, moved,
                                 i & 4 ? kGateError : -kGateError, &own_size);
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
        size = size.cwiseMax(own_size);
      }
      for (int k = 0; k < kIcpSums; ++k) {
        sums[k].low += low[k];
        sums[k].high += high[k];
        sums[k].size += size[k];
      }
    }
  return sums;
}

}  // namespace rosefusion::reference
