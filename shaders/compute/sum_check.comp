#version 450
#extension GL_GOOGLE_include_directive : require
// Adds the same numbers with and without compensation; the host compares both with the exact sum.
#include "shaders/compute/interface/sum_check.h"
#include "shaders/compute/lib/compensated_sum.glsl"

layout(local_size_x = 1) in;
layout(push_constant) uniform Push { SumCheckParams params; };
layout(std430, binding = kSumCheckBindValues) readonly restrict buffer Values { float values[]; };
layout(std430, binding = kSumCheckBindSums) writeonly restrict buffer Sums { float sums[]; };

void main() {
  CompensatedSum compensated = CompensatedSum(0.0, 0.0);
  float plain = 0.0;
  for (uint i = 0u; i < params.count; ++i) {
    add(compensated, values[i]);
    plain += values[i];
  }
  sums[0] = compensated.sum;
  sums[1] = plain;
}
