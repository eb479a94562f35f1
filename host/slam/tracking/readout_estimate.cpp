#include "host/slam/tracking/readout_estimate.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "host/slam/tracking/symmetric.h"

namespace rosefusion {
namespace {

// Before anything is measured: cameras give 30 images a second and read their rows within one.
constexpr double kExpected = 1.0 / 60;
// What else moves with the camera may look like it: the phases of a simulated Kinect v2 like 5 ms
// (tests/bench/notes/sensors.md#rolling-shutter).
constexpr double kFeigned = 0.002;
// Less is taken for none: images whose rows belong together are not to be touched.
constexpr double kCertain = 4;

}  // namespace

ReadoutEvidence readoutEvidence(std::span<const RefineSums> bands, const Vector6& motion, const Intrinsics& k,
                                double variance) {
  // The cost to second order, of a shift and turn of all rows and of a share of the motion by how far down
  // they are.
  Matrix6 hessian = Matrix6::Identity();  // a pose is known to a metre and a radian
  Vector6 gradient = Vector6::Zero(), mixed = Vector6::Zero();
  double curvature = 0, slope = 0;
  for (const RefineSums& sums : bands) {
    const double points = sums[shader::kRefineUsable];
    if (!(points > 0)) continue;
    const double row = (k.fy * sums[shader::kRefineRows] / points + k.cy + 0.5) / k.height - 0.5;
    const Matrix6 h = symmetric<6>(&sums[shader::kRefineHessian]) / variance;
    const Vector6 g = Eigen::Map<const Vector6>(&sums[shader::kRefineGradient]) / variance;
    hessian += h;
    gradient += g;
    mixed += row * h * motion;
    curvature += row * row * motion.dot(h * motion);
    slope += row * g.dot(motion);
  }
  const Vector6 along = hessian.ldlt().solve(mixed);
  return {std::max(0.0, curvature - along.dot(mixed)), along.dot(gradient) - slope};
}

void ReadoutEstimate::add(const ReadoutEvidence& evidence, double applied, double interval) {
  if (!(interval > 0)) return;
  const double information = evidence.information / (interval * interval);
  const double weighted = evidence.weighted / interval + information * applied;
  if (!std::isfinite(information) || !std::isfinite(weighted)) return;
  if (!(information > 0)) return;
  ++frames_;
  information_ += information;
  weighted_ += weighted;
  squares_ += weighted * weighted / information;
}

double ReadoutEstimate::deviation() const {
  // Frames differ by more than their noise says where other errors move with the camera, too; a time of
  // flight's phases, say (the ratio of Birge 1932).
  const double differ = frames_ > 1 ? (squares_ - weighted_ * weighted_ / information_) / (frames_ - 1) : 1;
  return 1 / std::sqrt(information_ / std::max(1.0, differ) + 1 / (kExpected * kExpected));
}

double ReadoutEstimate::seconds() const {
  const double variance = deviation() * deviation();
  const double mean =
      information_ > 0 ? weighted_ / information_ * (1 - variance / (kExpected * kExpected)) : 0;
  return std::abs(mean) > kCertain * std::hypot(deviation(), kFeigned) ? mean : 0;
}

}  // namespace rosefusion
