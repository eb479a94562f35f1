// Reference of passes fitness and fitness_reduce: the mean loss of a particle [eq:normallh], in double
// precision.
#pragma once
#include <map>
#include <span>
#include <vector>

#include "tests/reference/allocate.h"

namespace rosefusion::reference {

/// Of a position in voxels: up to some metres and page tables of a few hundred voxels, single precision, 4 cm
/// and more.
inline constexpr double kVoxelError = 2e-4;

/// A TSDF as it stands, voxel by voxel; what is not in a block reads as +1.
class VoxelValues {
 public:
  VoxelValues(std::span<const Block> blocks, std::span<const float> tsdf, double voxel_size);
  double at(const Eigen::Vector3i& voxel) const;
  double voxelSize() const { return voxel_size_; }

 private:
  std::map<Block, std::span<const float>> blocks_;
  double voxel_size_;
};

enum class LossKind { Squared, Absolute };

/// One particle: the swarm centre moved by a template entry (six numbers in the unit ball) times the axis
/// lengths (x, y, z in metres; qx, qy, qz): translation added, rotation applied on the left.
Pose particlePose(const Pose& centre, const Eigen::Matrix<double, 6, 1>& entry,
                  const Eigen::Matrix<double, 6, 1>& lengths);

/// The mean lies in [low, high]: points so near a voxel's face that rounding decides which voxel they read
/// make the two differ.
struct LossRange {
  double low = 0;
  double high = 0;
};

/// One point's loss at a particle's pose.
LossRange lossOf(const VoxelValues& values, const Eigen::Vector3d& point, const Pose& world_from_camera,
                 LossKind kind);

LossRange meanLoss(const VoxelValues& values, std::span<const Eigen::Vector3d> points,
                   const Pose& world_from_camera, LossKind kind);

struct RaceEnd {
  bool given_up = false;
  bool close = false;  ///< rounding decides; nothing is known of it
  int walked = 0;      ///< points looked up
};

/// Racing of particles [engine/passes/fitness.h]: points are looked up in up to 8 rounds of no fewer than 32,
/// each spread over all of them; particle i shares its fate with those i + a quarter of all and so on
/// (`together` of them); they are given up when the mean of each exceeds particle 0's by more than margin /
/// sqrt(points). `losses`: per particle and point.
std::vector<RaceEnd> race(std::span<const std::vector<LossRange>> losses, int together, double margin);

/// Counts as skipped the particles whose range is so wide that they test little.
Comparison compare(std::span<const LossRange> expected, std::span<const float> losses);

}  // namespace rosefusion::reference
