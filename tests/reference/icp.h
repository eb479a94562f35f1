// Reference of pass icp: point-to-plane normal equations with projective pairs, in double precision.
#pragma once
#include <span>
#include <vector>

#include "tests/reference/preprocess.h"
#include "tests/reference/refine.h"

namespace rosefusion::reference {

struct IcpModel {
  Intrinsics camera;
  Pose world_from_camera;                ///< from where the model was cast
  std::vector<Eigen::Vector4d> surface;  ///< by pixel: normal (world), depth; 0 where there is none
  int stride = 1;
  int offset = 0;
  double distance = 0.1;
  double cosine = 0.94;
  int reach = 4;
  double turn_sense = 1;  ///< of the turns' derivatives; -1 only to be wrong
};

constexpr int kIcpSums = 29;

/// In the order of pass icp: 21 of J^T J, 6 of J^T r, r^2, pairs. A pixel whose pair rounding decides widens
/// the ranges. `points`: by pixel, camera frame, w = 0 where invalid.
std::vector<SumRange> icpSums(const IcpModel& model, std::span<const Eigen::Vector4d> points,
                              const Pose& world_from_camera);

}  // namespace rosefusion::reference
