// Pass sum_check: the start-up test that compensated sums survive this driver's compiler.
#ifndef ROSEFUSION_INTERFACE_SUM_CHECK_H
#define ROSEFUSION_INTERFACE_SUM_CHECK_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kSumCheckBindValues = 0u;
const uint kSumCheckBindSums = 1u;  // [0]: compensated, [1]: plain

struct SumCheckParams {
  uint count;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
