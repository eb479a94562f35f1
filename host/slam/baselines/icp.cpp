#include "host/slam/baselines/icp.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Coarse to fine; the pyramid of KinectFusion has the same iterations on three halvings.
struct Level {
  int stride;
  int iterations;
};
constexpr Level kLevels[] = {{4, 10}, {2, 5}, {1, 4}};
constexpr double kLeastPairs = 50;
constexpr double kLeastPivot = 1e-5;  // of the normal equations, relative to their largest

}  // namespace

Icp::Icp(Device& device, const Settings& settings, const Intrinsics& intrinsics)
    : settings_(settings.icp),
      far_(static_cast<float>(settings.depth.max)),
      recorder_(device),
      raycast_(device, toShader(intrinsics), Memory::Device),
      icp_(device, toShader(intrinsics)) {}

TrackResult Icp::align(const DeviceFrame& frame, const Volume& volume, const Pose& last) {
  RaycastView view;
  view.world_from_camera = toShader(last);
  view.far = far_;
  view.colour = false;
  raycast_.record(recorder_, volume, view);
  recorder_.submit();
  TrackResult result;
  result.world_from_camera = last;
  for (const Level& level : kLevels) {
    const IcpPairing pairing{level.stride, static_cast<float>(settings_.distance),
                             static_cast<float>(std::cos(settings_.angle))};
    for (int i = 0; i < level.iterations; ++i) {
      icp_.record(recorder_, frame, raycast_, toShader(last.inverse()), pairing,
                  toShader(result.world_from_camera));
      recorder_.submit();
      const IcpSums sums = icp_.sums();
      ++result.iterations;
      result.lookups += icp_.cells();
      if (sums[shader::kIcpPairs] < kLeastPairs) return result;
      Matrix6 hessian;
      for (int row = 0, entry = shader::kIcpHessian; row < 6; ++row)
        for (int column = row; column < 6; ++column)
          hessian(row, column) = hessian(column, row) = sums[entry++];
      const Eigen::LDLT<Matrix6> solver(hessian);
      const auto pivots = solver.vectorD();
      if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return result;
      const Vector6 step = solver.solve(-Eigen::Map<const Vector6>(&sums[shader::kIcpGradient]));
      result.world_from_camera = moved(result.world_from_camera, step);
      if (step.cwiseAbs().maxCoeff() < settings_.minimum_move) break;
    }
  }
  return result;
}

}  // namespace rosefusion
