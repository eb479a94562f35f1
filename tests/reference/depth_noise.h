// How a depth camera errs, for the references.
#pragma once
#include <algorithm>

namespace rosefusion::reference {

/// Standard deviation floor + growth (z - 0.4 m)^2 [Nguyen, Izadi and Lovell 2012], never below the floor.
/// The default makes all depths alike.
struct DepthNoise {
  double floor = 0.005;
  double growth = 0;

  double deviation(double z) const { return z > 0.4 ? floor + growth * (z - 0.4) * (z - 0.4) : floor; }
  /// Inverse variance, in units of that close to the camera.
  double weight(double z) const { return floor * floor / (deviation(z) * deviation(z)); }
};

}  // namespace rosefusion::reference
