// How a depth camera errs, for the references.
#pragma once
#include <algorithm>
#include <cmath>

namespace rosefusion::reference {

/// Standard deviation floor + growth (z - 0.4 m)^2 [Nguyen, Izadi and Lovell 2012], never below the floor,
/// and bias_growth z^2 on top of it, independent of it and common to a surface. The default makes all depths
/// alike.
struct DepthNoise {
  double floor = 0.005;
  double growth = 0;
  double bias_growth = 0;

  double deviation(double z) const { return z > 0.4 ? floor + growth * (z - 0.4) * (z - 0.4) : floor; }
  double variance(double z) const { return deviation(z) * deviation(z) + std::pow(bias_growth * z * z, 2); }
  /// Inverse variance, in units of the floor's.
  double weight(double z) const { return floor * floor / variance(z); }
};

}  // namespace rosefusion::reference
