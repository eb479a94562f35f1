// How fast the camera goes at which moment.
#pragma once
#include <vector>

#include "host/synth/random.h"

namespace rosefusion {

/// Speeds in m/s or rad/s.
struct SpeedRange {
  double low = 0, mean = 0, high = 0;

  /// The range that ends at `new_high`, in the same proportions.
  SpeedRange endingAt(double new_high) const {
    return {new_high * low / high, new_high * mean / high, new_high};
  }
};

/// A smooth random speed over time within a range, that starts from rest and reaches `low` after `ramp`
/// seconds.
class SpeedProfile {
 public:
  /// The mean over all of `duration`, ramp included, is range.mean where the range and the ramp allow it; the
  /// largest value is just under range.high.
  SpeedProfile(const SpeedRange& range, double duration, double ramp, Rng& rng);

  double travelled(double time) const;  ///< integral of the speed from 0 to `time`
  double total() const { return travelled_.back(); }
  /// Moment at which `length` has been travelled; the duration when it never is.
  double timeAt(double length) const;

 private:
  double step_ = 0;
  std::vector<double> travelled_;
};

}  // namespace rosefusion
