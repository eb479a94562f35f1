// The quadratic B-spline that surfaces' gradients are taken of.
#pragma once
#include <cmath>

namespace rosefusion::reference {

/// Its value at a distance from the knot; 0 from 1.5 on.
inline double spline(double t) {
  const double a = std::abs(t);
  return a < 0.5 ? 0.75 - a * a : a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0;
}

/// Its derivative there.
inline double splineSlope(double t) {
  const double a = std::abs(t);
  return a < 0.5 ? -2 * t : a < 1.5 ? -std::copysign(1.5 - a, t) : 0;
}

}  // namespace rosefusion::reference
