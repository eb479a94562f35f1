#version 450
#extension GL_GOOGLE_include_directive : require
// Adds the same numbers with and without compensation; the host compares both with the exact sum.
#include "shaders/compute/interface/sum_check.h"
#include "shaders/compute/lib/compensated_sum.glsl"
#include "shaders/compute/lib/parameters.glsl"

layout(local_size_x = 1) in;
PUSHED_PARAMETERS(SumCheckParams)
layout(std430, binding = kSumCheckBindValues) readonly restrict buffer Values { float values[]; };
layout(std430, binding = kSumCheckBindSums) restrict buffer Sums { float sums[]; };

void main() {
  CompensatedSum compensated = CompensatedSum(sums[kSumCompensated], sums[kSumLost]);
  float plain = sums[kSumPlain];
  for (uint i = params.first; i < params.first + params.count; ++i) {
    add(compensated, values[i]);
    plain += values[i];
  }
  sums[kSumCompensated] = compensated.sum;
  sums[kSumPlain] = plain;
  sums[kSumLost] = compensated.lost;
}
