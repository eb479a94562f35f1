#version 450
#extension GL_GOOGLE_include_directive : require
// Adds the slices of every particle, in order and compensated, and divides by the number of points [eq:normallh].
#include "shaders/compute/interface/fitness_reduce.h"
#include "shaders/compute/lib/compensated_sum.glsl"

layout(local_size_x = kFitnessReduceGroup) in;
layout(push_constant) uniform Push { FitnessReduceParams params; };
layout(std430, binding = kFitnessReduceBindPartial) readonly restrict buffer Partial { vec2 partial[]; };
layout(std430, binding = kFitnessReduceBindCount) readonly restrict buffer Count { uint count[]; };
layout(std430, binding = kFitnessReduceBindLoss) writeonly restrict buffer Loss { float loss[]; };

void main() {
  uint particle = gl_GlobalInvocationID.x;
  if (particle >= params.particles) return;
  CompensatedSum sum = CompensatedSum(0.0, 0.0);
  for (uint slice = 0u; slice < params.slices; ++slice) {
    vec2 part = partial[slice * params.particles + particle];
    add(sum, part.x);
    add(sum, -part.y);
  }
  loss[particle] = count[0] > 0u ? sum.sum / float(count[0]) : -1.0;
}
