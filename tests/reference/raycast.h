// Reference of pass raycast: small steps through the interpolated field, bisection, doubles.
#pragma once
#include "tests/reference/raycast_field.h"

namespace rosefusion::reference {

struct RayHit {
  bool hit = false;
  double distance = 0;                               ///< metres along the ray
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit length, towards free space
};

/// First place in [begin, end] (metres along the unit `direction`) where the trilinear TSDF falls through
/// zero, with all eight voxels around it observed.
RayHit castRay(const Field& field, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
               double begin, double end);

}  // namespace rosefusion::reference
