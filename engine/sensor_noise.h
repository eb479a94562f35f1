// How a depth camera errs.
#pragma once

namespace rosefusion {

/// Standard deviation of a depth z, metres: floor + growth (z - 0.4 m)^2 (Nguyen, Izadi and Lovell 2012), and
/// bias_growth z^2 that the depths of a surface share. The default makes all depths alike.
struct SensorNoise {
  float floor = 0.005f;
  float growth = 0;       ///< 1 / metre
  float bias_growth = 0;  ///< 1 / metre
};

}  // namespace rosefusion
