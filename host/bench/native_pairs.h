// A pass measured beside its native loop, and whether both give the same.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/bench/pass_bench.h"
#include "host/bench/stopwatch.h"

namespace rosefusion {

/// Measurements in pairs: what the machine does besides hits both of a pair.
class NativePairs {
 public:
  /// Times both once, the native loop first in every second pair; `counted`: false to warm up.
  template <typename Device, typename Native>
  void measure(bool counted, Device&& device, Native&& native) {
    PassTime d, n;
    if (number_++ % 2) n = timed(native);
    d = timed(device);
    if (number_ % 2) n = timed(native);
    if (!counted) return;
    device_.push_back(d);
    native_.push_back(n);
  }
  /// Medians; the ratios are those of the pairs' ratios. At least one pair must have been counted.
  PairedTime figures() const;

 private:
  std::vector<PassTime> device_, native_;
  std::size_t number_ = 0;
};

/// Share of the numbers that are more than `tolerance` apart, or are none, or are missing on one side.
double shareApart(std::span<const float> device, std::span<const float> native, double tolerance);

/// `apart`, the share of a pass's numbers, again. Throws std::runtime_error, naming device and pass, where it
/// is above `allowed`.
double requireShare(const std::string& device_name, const char* pass, double apart, double allowed);

}  // namespace rosefusion
