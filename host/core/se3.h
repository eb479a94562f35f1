// Rigid transforms: how far two of them are apart, and one moved by a small step.
#pragma once
#include <Eigen/Geometry>

namespace rosefusion {

/// Rigid transform; as a camera pose it is world_from_camera (camera: x right, y down, z forward), metres.
using Pose = Eigen::Isometry3d;
/// A shift in metres and then a turn, by its rotation vector in radians unless said otherwise.
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Of a camera in its own frame, per second: metres, and radians as a rotation vector.
struct Velocity {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
};

/// Rotation angle of a rigid transform, radians in [0, pi].
double rotationAngle(const Pose& pose);
/// Metres between two poses' origins.
double shiftBetween(const Pose& a, const Pose& b);
/// Radians in [0, pi] between two orientations.
double turnBetween(const Pose& a, const Pose& b);
double turnBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);
/// Whether two poses are less than this apart, in metres and radians.
bool areNear(const Pose& a, const Pose& b, double shift, double turn);

/// The rotation, about an axis of the world, that takes the orientation of `from` to that of `to`.
Eigen::AngleAxisd turnInWorld(const Pose& from, const Pose& to);
/// The step of moved() that leads from `from` to `to`.
Vector6 difference(const Pose& from, const Pose& to);
/// `pose` shifted in the world by the first three of `step` and turned about its own centre by the last
/// three, a rotation vector applied from the left.
Pose moved(const Pose& pose, const Vector6& step);
/// The same with the turn as a unit quaternion.
Pose moved(const Pose& pose, const Eigen::Vector3d& shift, const Eigen::Quaterniond& turn);

/// Unit quaternion with w >= 0, so that the imaginary part alone describes the rotation.
Eigen::Quaterniond canonical(const Eigen::Quaterniond& q);

}  // namespace rosefusion
