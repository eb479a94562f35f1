#version 450
#extension GL_GOOGLE_include_directive : require
// Adds the slices of every particle, in order and compensated, and divides by the number of points [eq:normallh].
#include "shaders/compute/interface/fitness_reduce.h"
#include "shaders/compute/lib/compensated_sum.glsl"
#include "shaders/compute/lib/parameters.glsl"

layout(local_size_x = kFitnessReduceGroup) in;
PUSHED_PARAMETERS(FitnessReduceParams)
layout(std430, binding = kFitnessReduceBindPartial) readonly restrict buffer Partial { vec4 partial[]; };
layout(std430, binding = kFitnessReduceBindLoss) writeonly restrict buffer Loss { float loss[]; };
layout(std430, binding = kFitnessReduceBindCounted) writeonly restrict buffer Counted { uint counted[]; };
layout(std430, binding = kFitnessReduceBindWalked) writeonly restrict buffer Walked { uint walked[]; };

void main() {
  uint particle = gl_GlobalInvocationID.x;
  if (particle >= params.particles) return;
  CompensatedSum sum = CompensatedSum(0.0, 0.0);
  float points = 0.0, looked_up = 0.0;  // exact: far fewer than 2^24
  for (uint slice = 0u; slice < params.slices; ++slice) {
    vec4 part = partial[slice * params.particles + particle];
    add(sum, part.x);
    add(sum, -part.y);
    points += part.z;
    looked_up += part.w;
  }
  loss[particle] = points > 0.0 ? sum.sum / points : -1.0;
  counted[particle] = uint(points);
  walked[particle] = uint(looked_up);
}
