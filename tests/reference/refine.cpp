#include "tests/reference/refine.h"

#include <array>
#include <cmath>

#include "tests/reference/spline.h"

namespace rosefusion::reference {
namespace {

using RefineSums = Eigen::Matrix<double, kRefineSums, 1>;

// Of a term, relative to the sizes of its factors: some ten single-precision operations on each, and the
// interpolation's 27 products of numbers up to 1 where the gradient is about a third (6e-8 * 27 * 3).
constexpr double kTermTolerance = 6e-6;
constexpr double kSeenError = 2e-6;  // of a point's place before the last camera, relative: single precision
constexpr double kTruncated = 0.999;
constexpr double kWide = 0.01;

/// The trilinear interpolation of voxel centres, and whether all eight tell a distance.
struct Reading {
  double value = 0;
  bool usable = true;
};

Reading interpolate(const VoxelValues& values, const Eigen::Vector3d& position) {
  const Eigen::Vector3d centred = position.array() - 0.5;
  const Eigen::Vector3i corner = centred.array().floor().cast<int>();
  Reading out;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3i voxel = corner + Eigen::Vector3i(i & 1, i >> 1 & 1, i >> 2);
    const double stored = values.at(voxel);
    out.usable = out.usable && std::abs(stored) < kTruncated;
    out.value += stored * (1 - (centred - voxel.cast<double>()).array().abs()).prod();
  }
  return out;
}

struct Slope {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< per voxel
  bool known = true;                                   ///< none of the 27 voxels is truncated or unobserved
};

Slope smoothGradient(const VoxelValues& values, const Eigen::Vector3d& position) {
  const Eigen::Vector3i middle = position.array().floor().cast<int>();
  Slope slope;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Eigen::Vector3i voxel = middle + Eigen::Vector3i(x, y, z);
        const Eigen::Vector3d t = position - (voxel.cast<double>().array() + 0.5).matrix();
        const double stored = values.at(voxel);
        for (int axis = 0; axis < 3; ++axis)
          slope.gradient[axis] +=
              stored * splineSlope(t[axis]) * spline(t[(axis + 1) % 3]) * spline(t[(axis + 2) % 3]);
        slope.known = slope.known && std::abs(stored) < kTruncated;
      }
  return slope;
}

double robust(double distance, double huber) {
  const double a = std::abs(distance);
  return a < huber ? a * a / 2 : huber * a - huber * huber / 2;
}

/// Whether the image holds all that is up to `around` (metres) beside the point.
bool heldBy(const Intrinsics& k, const Eigen::Vector3d& point, double around) {
  if (point.z() <= 0) return false;
  const double u = k.fx * point.x() / point.z() + k.cx, v = k.fy * point.y() / point.z() + k.cy;
  const double border = std::max(k.fx, k.fy) * around / point.z() - 0.5;
  return u >= border && v >= border && u < k.width - 1 - border && v < k.height - 1 - border;
}

/// What a point adds to the sums when it reads the volume at `position` (voxels); `arm`: from the camera's
/// centre, in world axes, and `point` in its own; `held_by_last`: whether the last image holds it; `size`:
/// bounds on the terms, from the lengths of their factors.
RefineSums terms(const VoxelValues& values, const VoxelValues& weights, const Eigen::Vector3d& position,
                 const Eigen::Vector3d& arm, const Eigen::Vector3d& point, bool held_by_last,
                 const RefineModel& model, RefineSums* size) {
  RefineSums out = RefineSums::Zero(), bound = RefineSums::Zero();
  const double z = point.z();
  const Reading reading = interpolate(values, position);
  double variance = model.noise.variance(z);
  if (reading.usable)
    variance += std::pow(model.model_noise, 2) / weights.at(position.array().floor().cast<int>());
  const double cost_weight = model.huber * model.huber / (model.huber * model.huber + variance);
  out[28] = cost_weight * robust(model.truncation, model.huber);
  const Slope read = smoothGradient(values, position);
  if (!reading.usable) {
    if (!held_by_last) out[28] = 0;
    out[27] = out[28];
  } else if (model.front_only && read.known &&
             read.gradient.dot(arm) > model.back_cosine * read.gradient.norm() * arm.norm()) {
    out[28] = 0;
  } else {
    const double residual = reading.value * model.truncation;
    const Eigen::Vector3d slope = read.known
                                      ? Eigen::Vector3d(read.gradient * model.truncation / values.voxelSize())
                                      : Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 6, 1> jacobian, length;
    jacobian << slope, model.turn_sense * arm.cross(slope);
    length.head<3>().setConstant(slope.norm());
    length.tail<3>().setConstant(slope.norm() * arm.norm());
    double weight = std::pow(model.noise.floor, 2) / variance;
    if (std::abs(residual) > model.huber) weight *= model.huber / std::abs(residual);
    int entry = 0;
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column, ++entry) {
        out[entry] = weight * jacobian[row] * jacobian[column];
        bound[entry] = weight * length[row] * length[column];
      }
    out.segment<6>(21) = weight * residual * jacobian;
    bound.segment<6>(21) = weight * std::abs(residual) * length;
    out[27] = cost_weight * robust(residual, model.huber);
    out[29] = cost_weight;
    out[30] = 1;
    const double usual = model.close_deviations * model.noise.deviation(z);
    out[31] = std::abs(residual) < model.huber || std::abs(residual) < usual ? 1 : 0;
  }
  if (out[30] > 0) out[32] = point.y() / z;
  bound.tail<6>() = out.tail<6>().cwiseAbs();
  if (size) *size = bound;
  return out;
}

}  // namespace

std::vector<SumRange> refineSums(const VoxelValues& values, const VoxelValues& weights,
                                 std::span<const Eigen::Vector3d> points, const Pose& world_from_camera,
                                 const RefineModel& model) {
  std::vector<SumRange> sums(kRefineSums);
  const auto holds = [&](const Eigen::Vector3d& seen) {
    return heldBy(model.last_camera, seen, std::sqrt(3.0) * values.voxelSize());
  };
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d arm = world_from_camera.linear() * point;
    const Eigen::Vector3d position = (arm + world_from_camera.translation()) / values.voxelSize();
    const Eigen::Vector3d seen = model.last_from_world * (arm + world_from_camera.translation());
    RefineSums size;
    RefineSums low = terms(values, weights, position, arm, point, holds(seen), model, &size), high = low;
    // The terms are smooth within a cell, so the corners of what rounding can reach hold their extremes, and
    // they lie in every cell that it can reach.
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const bool held = holds(seen + kSeenError * seen.norm() * sign);
      const RefineSums at =
          terms(values, weights, position + kVoxelError * sign, arm, point, held, model, nullptr);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    for (int k = 0; k < kRefineSums; ++k) {
      sums[k].low += low[k];
      sums[k].high += high[k];
      sums[k].size += size[k];
    }
  }
  return sums;
}

Comparison compare(std::span<const SumRange> expected, std::span<const double> sums, std::size_t per_pose) {
  Comparison result;
  for (std::size_t i = 0; i < std::min(expected.size(), sums.size()); ++i) {
    const auto [low, high, size] = expected[i];
    if (high - low > kWide * size) ++result.skipped;
    const double error = std::max({0.0, low - sums[i], sums[i] - high});
    result.add(error == 0 ? 0 : error / (kTermTolerance * size),
               "sum " + std::to_string(i % per_pose) + " of pose " + std::to_string(i / per_pose) + ": " +
                   std::to_string(sums[i]) + ", expected " + std::to_string(low) + " to " +
                   std::to_string(high));
  }
  if (expected.size() != sums.size()) result.add(INFINITY, "the number of sums differs");
  return result;
}

}  // namespace rosefusion::reference
