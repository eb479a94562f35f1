#include "tests/reference/fitness.h"

#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {
// Voxels: positions up to some metres and page tables of a few hundred voxels, single precision, 4 cm and
// more.
constexpr double kVoxelError = 2e-4;
// A compensated sum of single-precision squares, and the rounding of its mean.
constexpr double kRelativeTolerance = 3e-7;
constexpr double kWide = 2e-3;
}  // namespace

VoxelValues::VoxelValues(std::span<const Block> blocks, std::span<const float> tsdf, double voxel_size)
    : voxel_size_(voxel_size) {
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks_[blocks[i]] = tsdf.subspan(512 * i, 512);
}

double VoxelValues::at(const Eigen::Vector3i& voxel) const {
  Block block;
  std::array<int, 3> local;
  for (int axis = 0; axis < 3; ++axis) {
    block[axis] = int(std::floor(voxel[axis] / 8.0));
    local[axis] = voxel[axis] - 8 * block[axis];
  }
  const auto found = blocks_.find(block);
  return found == blocks_.end() ? 1.0 : found->second[64 * local[2] + 8 * local[1] + local[0]];
}

Pose particlePose(const Pose& centre, const Eigen::Matrix<double, 6, 1>& entry,
                  const Eigen::Matrix<double, 6, 1>& lengths) {
  const Eigen::Vector3d v = entry.tail<3>().cwiseProduct(lengths.tail<3>());
  // |v| is the sine of half the angle; longer than 1 is half a turn.
  const double angle = 2 * std::asin(std::min(1.0, v.norm()));
  Pose pose = centre;
  if (v.norm() > 0)
    pose.linear() = Eigen::AngleAxisd(angle, v.normalized()).toRotationMatrix() * centre.linear();
  pose.translation() = centre.translation() + entry.head<3>().cwiseProduct(lengths.head<3>());
  return pose;
}

LossRange meanLoss(const VoxelValues& values, std::span<const Eigen::Vector3d> points,
                   const Pose& world_from_camera, LossKind kind) {
  LossRange sum;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d position = world_from_camera * point / values.voxelSize();
    const Eigen::Vector3i first = (position.array() - kVoxelError).floor().cast<int>();
    const Eigen::Vector3i last = (position.array() + kVoxelError).floor().cast<int>();
    double low = INFINITY, high = 0;
    for (int z = first.z(); z <= last.z(); ++z)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int x = first.x(); x <= last.x(); ++x) {
          const double psi = values.at({x, y, z});
          const double loss = kind == LossKind::Squared ? psi * psi : std::abs(psi);
          low = std::min(low, loss);
          high = std::max(high, loss);
        }
    sum.low += low;
    sum.high += high;
  }
  const double count = static_cast<double>(points.size());
  return {sum.low / count, sum.high / count};
}

Comparison compare(std::span<const LossRange> expected, std::span<const float> losses) {
  Comparison result;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto [low, high] = expected[i];
    const double loss = losses[i], error = std::max({0.0, low - loss, loss - high});
    if (high - low > kWide) ++result.skipped;
    result.add(error / (kRelativeTolerance * high), "particle " + std::to_string(i) + ": " +
                                                        std::to_string(loss) + ", expected " +
                                                        std::to_string(low) + " to " + std::to_string(high));
  }
  if (expected.size() != losses.size()) result.add(INFINITY, "the number of losses differs");
  return result;
}

}  // namespace rosefusion::reference
