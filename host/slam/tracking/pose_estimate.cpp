#include "host/slam/tracking/pose_estimate.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace rosefusion {
namespace {

double largestDeviation(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]);
}

}  // namespace

double PoseFit::shiftDeviation() const {
  return largestDeviation(covariance.topLeftCorner<3, 3>());
}

double PoseFit::turnDeviation() const {
  return largestDeviation(covariance.bottomRightCorner<3, 3>());
}

}  // namespace rosefusion
