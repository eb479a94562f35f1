#include "host/core/se3.h"

namespace rosefusion {

double rotationAngle(const Pose& pose) {
  return Eigen::AngleAxisd(pose.linear()).angle();
}

double shiftBetween(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

double turnBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle();
}

double turnBetween(const Pose& a, const Pose& b) {
  return turnBetween(Eigen::Matrix3d(a.linear()), Eigen::Matrix3d(b.linear()));
}

bool areNear(const Pose& a, const Pose& b, double shift, double turn) {
  return shiftBetween(a, b) < shift && turnBetween(a, b) < turn;
}

Eigen::AngleAxisd turnInWorld(const Pose& from, const Pose& to) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
}

Vector6 difference(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn = turnInWorld(from, to);
  Vector6 out;
  out << to.translation() - from.translation(), turn.angle() * turn.axis();
  return out;
}

Pose moved(const Pose& pose, const Eigen::Vector3d& shift, const Eigen::Quaterniond& turn) {
  Pose out = Pose::Identity();
  out.linear() = (turn * Eigen::Quaterniond(pose.linear())).normalized().toRotationMatrix();
  out.translation() = pose.translation() + shift;
  return out;
}

Pose moved(const Pose& pose, const Vector6& step) {
  const double angle = step.tail<3>().norm();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (angle > 0) turn = Eigen::AngleAxisd(angle, step.tail<3>() / angle);
  return moved(pose, step.head<3>(), turn);
}

Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  return q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

}  // namespace rosefusion
