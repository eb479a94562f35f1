#include "tests/reference/fitness.h"

#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {
// A compensated sum of single-precision squares, and the rounding of its mean.
constexpr double kRelativeTolerance = 3e-7;
constexpr double kWide = 2e-3;
constexpr double kRaceTolerance = 1e-5;  // single precision in the race's bound
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

LossRange lossOf(const VoxelValues& values, const Eigen::Vector3d& point, const Pose& world_from_camera,
                 LossKind kind) {
  const Eigen::Vector3d position = world_from_camera * point / values.voxelSize();
  const Eigen::Vector3i first = (position.array() - kVoxelError).floor().cast<int>();
  const Eigen::Vector3i last = (position.array() + kVoxelError).floor().cast<int>();
  LossRange range{INFINITY, 0};
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const double psi = values.at({x, y, z});
        const double loss = kind == LossKind::Squared ? psi * psi : std::abs(psi);
        range.low = std::min(range.low, loss);
        range.high = std::max(range.high, loss);
      }
  return range;
}

LossRange meanLoss(const VoxelValues& values, std::span<const Eigen::Vector3d> points,
                   const Pose& world_from_camera, LossKind kind) {
  LossRange sum;
  for (const Eigen::Vector3d& point : points) {
    const LossRange range = lossOf(values, point, world_from_camera, kind);
    sum.low += range.low;
    sum.high += range.high;
  }
  const double count = static_cast<double>(points.size());
  return {sum.low / count, sum.high / count};
}

std::vector<RaceEnd> race(std::span<const std::vector<LossRange>> losses, int together, double margin) {
  const auto particles = losses.size(), points = losses[0].size();
  const std::size_t groups = (particles + together - 1) / together;
  const std::size_t rounds = std::clamp<std::size_t>(points / 32, 1, 8);
  std::vector<RaceEnd> ends(particles);
  for (std::size_t group = 0; group < groups; ++group) {
    RaceEnd end;
    std::vector<LossRange> sums(together + 1);  // the last one is particle 0's
    for (std::size_t round = 0; round < rounds && !end.given_up && !end.close; ++round) {
      for (std::size_t i = round; i < points; i += rounds, ++end.walked)
        for (int k = 0; k <= together; ++k) {
          const std::size_t particle = k == together ? 0 : std::min(group + k * groups, particles - 1);
          sums[k].low += losses[particle][i].low;
          sums[k].high += losses[particle][i].high;
        }
      const double n = end.walked;
      const LossRange bound{sums[together].low + margin * std::sqrt(n),
                            sums[together].high + margin * std::sqrt(n)};
      bool all = true, any = true;  // surely, possibly
      for (int k = 0; k < together; ++k) {
        all = all && sums[k].low > bound.high * (1 + kRaceTolerance);
        any = any && sums[k].high > bound.low * (1 - kRaceTolerance);
      }
      end.given_up = all;
      end.close = any && !all;
    }
    for (int k = 0; k < together; ++k)
      if (group + k * groups < particles) ends[group + k * groups] = end;
  }
  return ends;
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
