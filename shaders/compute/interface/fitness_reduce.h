// Pass fitness_reduce: adds the slices of every particle and divides by the number of points.
#ifndef ROSEFUSION_INTERFACE_FITNESS_REDUCE_H
#define ROSEFUSION_INTERFACE_FITNESS_REDUCE_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kFitnessReduceGroup = 64u;
const uint kFitnessReduceBindPartial = 0u;
const uint kFitnessReduceBindLoss = 1u;     // mean loss per particle; negative when no point was counted
const uint kFitnessReduceBindCounted = 2u;  // points counted per particle
const uint kFitnessReduceBindWalked = 3u;   // points looked up per particle, counted or not

struct FitnessReduceParams {
  uint particles;
  uint slices;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
