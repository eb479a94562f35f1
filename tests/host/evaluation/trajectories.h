// Trajectories with known shapes for the tests of this folder.
#pragma once
#include <cmath>
#include <cstddef>
#include <random>

#include "host/core/trajectory.h"

namespace rosefusion::testing {

inline Pose makePose(const Eigen::Vector3d& position, double angle, const Eigen::Vector3d& axis) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = position;
  return pose;
}

/// Some pose far from the identity.
inline Pose somewhere() {
  return makePose({3, -7, 0.5}, 2.2, {1, -2, 0.5});
}

/// A curve that fills all three dimensions and turns about all axes; 30 frames a second.
inline Trajectory curve(std::size_t frames) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / 30;
    trajectory.push_back({t, makePose({std::sin(t), 0.5 * std::cos(1.7 * t), 0.3 * std::sin(2.9 * t)},
                                      0.8 * t, {std::cos(t), 1, std::sin(0.5 * t)})});
  }
  return trajectory;
}

inline Trajectory moved(const Pose& by, Trajectory trajectory) {
  for (StampedPose& p : trajectory) p.world_from_camera = by * p.world_from_camera;
  return trajectory;
}

inline bool isProperRotation(const Eigen::Matrix3d& r) {
  return (r * r.transpose()).isIdentity(1e-12) && std::abs(r.determinant() - 1) < 1e-12;
}

}  // namespace rosefusion::testing
