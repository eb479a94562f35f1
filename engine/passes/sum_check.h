// Pass sum_check: does compensated summation survive this device's compiler?
#pragma once
#include <span>

#include "engine/recorder.h"

namespace rosefusion {

struct SumCheck {
  float compensated = 0;
  float plain = 0;
};

/// Adds `values` in order on the device, with and without compensation. Submits and waits.
SumCheck sumOnDevice(Device& device, std::span<const float> values);

/// True when the device's compensated mean of {16777216, 1, -16777216} is 1/3, which a plain sum cannot give.
bool compensatedSumsWork(Device& device);

}  // namespace rosefusion
