// Reference of pass refine: the normal equations of the depth's distance to the TSDF, in double precision.
#pragma once
#include <span>
#include <vector>

#include "tests/reference/depth_noise.h"
#include "tests/reference/fitness.h"

namespace rosefusion::reference {

struct RefineModel {
  double truncation = 0.12;  ///< metres, what a TSDF value of 1 stands for
  double huber = 0.02;       ///< metres
  DepthNoise noise;
  double model_noise = 0;  ///< metres, of the surface in a voxel of weight 1
  bool front_only =
      false;  ///< points where the surface shows its back, looked at from the camera, are left out
  double back_cosine = 0.2;     ///< of the angle between the surface's normal and the view, from where on
  double close_deviations = 2;  ///< of the depth's noise, within which a point is close to the surface
  double turn_sense = 1;        ///< of the turns' derivatives; -1 only to be wrong
  Pose last_from_world = Pose::Identity();
  Intrinsics last_camera;
};

/// A sum lies in [low, high]: the voxels' neighbourhoods are read at positions that single precision moves,
/// and near a cell's face that decides whether a point reads a distance. `size`: what the terms can add up to
/// without cancelling.
struct SumRange {
  double low = 0;
  double high = 0;
  double size = 0;
};

/// In this order: 21 of the upper triangle of J^T W J, row by row; 6 of J^T W r; the robust cost; the cost if
/// no point read a distance; the cost weights of the points that read one; the number of these; how many of
/// them are close: nearer than huber, or than noise explains; y / z of those that read a distance. Unknowns:
/// shift in the world, turn about the camera's centre.
constexpr int kRefineSums = 33;

/// `weights`: what each voxel of `values` gathered.
std::vector<SumRange> refineSums(const VoxelValues& values, const VoxelValues& weights,
                                 std::span<const Eigen::Vector3d> points, const Pose& world_from_camera,
                                 const RefineModel& model);

/// Counts as skipped the sums whose range is so wide that they test little. `per_pose`: how many sums a pose
/// has.
Comparison compare(std::span<const SumRange> expected, std::span<const double> sums,
                   std::size_t per_pose = kRefineSums);

}  // namespace rosefusion::reference
