#include "host/evaluation/alignment.h"

#include <Eigen/SVD>

namespace rosefusion {
namespace {

// Extents below a millionth of the largest one carry no direction: poses are stored with six to nine digits.
// The covariance holds squares of extents.
constexpr double kRankTolerance = 1e-12;
// Below a nanometre the camera did not move.
constexpr double kNoMotionSquared = 1e-18;

/// Rotation R that maximises trace(R^T M).
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign.z() = -1;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

Alignment alignPoses(const std::vector<PosePair>& pairs, double lever_m) {
  Alignment result;
  if (pairs.empty()) {
    result.description = "not aligned: no common poses";
    return result;
  }
  const double n = static_cast<double>(pairs.size());
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero(), truth_mean = Eigen::Vector3d::Zero();
  for (const PosePair& p : pairs) {
    estimate_mean += p.estimate.translation() / n;
    truth_mean += p.truth.translation() / n;
  }
  Eigen::Matrix3d positions = Eigen::Matrix3d::Zero(), orientations = Eigen::Matrix3d::Zero();
  for (const PosePair& p : pairs) {
    positions +=
        (p.truth.translation() - truth_mean) * (p.estimate.translation() - estimate_mean).transpose() / n;
    orientations += p.truth.linear() * p.estimate.linear().transpose() / n;
  }
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3d>(positions).singularValues();
  const bool moved = spread[0] > kNoMotionSquared;
  result.positions_suffice = moved && spread[1] > kRankTolerance * spread[0];

  double lever_squared = lever_m * lever_m;
  result.description = "rigid SE(3) alignment, no scale, least squares over positions (Umeyama 1991)";
  if (lever_m > 0) {
    result.description = "rigid SE(3) alignment, no scale, least squares over positions and orientations";
  } else if (!result.positions_suffice) {
    // So small a lever that it only decides what the positions leave open.
    lever_squared = moved ? 1e-8 * spread[0] : 1;
    result.description += moved ? "; the motion is a straight line, so orientations decide the roll about it"
                                : "; the positions do not move, so orientations decide the rotation";
  }
  result.truth_from_estimate.linear() = nearestRotation(positions + lever_squared * orientations);
  result.truth_from_estimate.translation() = truth_mean - result.truth_from_estimate.linear() * estimate_mean;
  return result;
}

}  // namespace rosefusion
