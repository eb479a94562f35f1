#version 450
#extension GL_GOOGLE_include_directive : require
// 16-bit depth to metres; 0, 65535 and what lies outside the range is invalid, and, on demand, pixels where the surface bends
// or jumps by more than the sensor's noise.
#include "shaders/compute/interface/preprocess.h"
#include "shaders/compute/lib/depth_noise.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

layout(local_size_x = kPreprocessGroup) in;
PUSHED_PARAMETERS(PreprocessParams)
READ_WORDS(rawPair, kPreprocessBindRaw)
layout(std430, binding = kPreprocessBindDepth) writeonly restrict buffer Depth { float depth[]; };

// Metres; 0 where invalid.
float metresOf(uint value) {
  float z = float(value) * params.metres_per_unit;
  return value != 0u && value != 65535u && z >= params.min_depth && z <= params.max_depth ? z : 0.0;
}

float metresAt(ivec2 at) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, params.size.xy))) return 0.0;
  uint pixel = uint(at.y * params.size.x + at.x);
  return metresOf((rawPair(pixel >> 1) >> (16u * (pixel & 1u))) & 0xFFFFu);
}

// On a plane 1 / z is linear in the image, however steep the plane is.
bool bends(float before, float z, float after) {
  if (before == 0.0 || after == 0.0) return false;
  float bend = abs(1.0 / before + 1.0 / after - 2.0 / z) * z * z;
  return bend > params.edge_sigmas * depthNoise(params.noise_floor, params.noise_growth, z);
}

void convert(uint pixel, uint value) {
  ivec2 at = ivec2(pixel % uint(params.size.x), pixel / uint(params.size.x));
  float z = metresOf(value);
  if (z > 0.0 && params.edge_sigmas > 0.0) {
    const ivec2 kX = ivec2(kEdgeReach, 0), kY = ivec2(0, kEdgeReach);
    if (bends(metresAt(at - kX), z, metresAt(at + kX)) || bends(metresAt(at - kY), z, metresAt(at + kY))) z = 0.0;
  }
  depth[pixel] = z;
}

void main() {
  uint pixels = uint(params.size.x * params.size.y);
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  uint number = group * kPreprocessGroup + gl_LocalInvocationID.x, first = 2u * number;
  if (first >= pixels) return;
  uint pair = rawPair(number);
  convert(first, pair & 0xFFFFu);
  if (first + 1u < pixels) convert(first + 1u, pair >> 16);
}
