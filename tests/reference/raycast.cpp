#include "tests/reference/raycast.h"

#include <cmath>

#include "tests/reference/spline.h"

namespace rosefusion::reference {
namespace {

constexpr double kStep = 0.2;  // voxels
constexpr int kBisections = 40;

struct Sample {
  double value = 1;
  bool observed = true;
};

Sample sampleAt(const Field& field, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = world / field.voxelSize() - Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3d base = p.array().floor();
  Sample sample{0, true};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i voxel =
        base.cast<int>() + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
    const Eigen::Array3d distance = (p - voxel.cast<double>()).array().abs();
    sample.value += (1 - distance).prod() * field.tsdf(voxel);
    sample.observed = sample.observed && field.weight(voxel) > 0;
  }
  return sample;
}

Eigen::Vector3d splineGradient(const Field& field, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = world / field.voxelSize() - Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3i base = p.array().floor().cast<int>();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (int z = -1; z <= 2; ++z)
    for (int y = -1; y <= 2; ++y)
      for (int x = -1; x <= 2; ++x) {
        const Eigen::Vector3i voxel = base + Eigen::Vector3i(x, y, z);
        const Eigen::Vector3d d = p - voxel.cast<double>();
        for (int axis = 0; axis < 3; ++axis)
          gradient[axis] += field.tsdf(voxel) * splineSlope(d[axis]) * spline(d[(axis + 1) % 3]) *
                            spline(d[(axis + 2) % 3]);
      }
  return gradient;
}

}  // namespace

RayHit castRay(const Field& field, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
               double begin, double end) {
  const double step = kStep * field.voxelSize();
  Sample previous{1, false};
  for (double t = begin; t < end; t += step) {
    const Sample sample = sampleAt(field, origin + t * direction);
    if (sample.value < 0 && sample.observed && previous.value >= 0 && previous.observed) {
      double before = t - step, behind = t;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (before + behind);
        (sampleAt(field, origin + middle * direction).value >= 0 ? before : behind) = middle;
      }
      return {true, before, splineGradient(field, origin + before * direction).normalized()};
    }
    previous = sample;
  }
  return {};
}

}  // namespace rosefusion::reference
