// Pass sum_check: the start-up test that compensated sums survive this driver's compiler.
#ifndef ROSEFUSION_INTERFACE_SUM_CHECK_H
#define ROSEFUSION_INTERFACE_SUM_CHECK_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kSumCheckBindValues = 0u;
const uint kSumCheckBindSums = 1u;  // carried on from one dispatch to the next
const uint kSumCompensated = 0u;
const uint kSumPlain = 1u;
const uint kSumLost = 2u;  // the compensation

struct SumCheckParams {
  uint first;
  uint count;  // at most kLongestLoop
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
