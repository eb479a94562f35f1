#version 450
#extension GL_GOOGLE_include_directive : require
// 16-bit depth to metres and camera-frame points; 0, 65535 and what lies outside the range is invalid. No smoothing:
// the paper tracks on raw depth.
#include "shaders/compute/interface/preprocess.h"

layout(local_size_x = kPreprocessGroup) in;
layout(push_constant) uniform Push { PreprocessParams params; };
layout(std430, binding = kPreprocessBindRaw) readonly restrict buffer Raw { uint raw[]; };
layout(std430, binding = kPreprocessBindDepth) writeonly restrict buffer Depth { float depth[]; };
layout(std430, binding = kPreprocessBindPoints) writeonly restrict buffer Points { vec4 points[]; };

void convert(uint pixel, uint value) {
  float z = float(value) * params.metres_per_unit;
  bool valid = value != 0u && value != 65535u && z >= params.min_depth && z <= params.max_depth;
  vec2 uv = vec2(pixel % uint(params.size.x), pixel / uint(params.size.x));
  vec2 ray = (uv - params.focal_centre.zw) / params.focal_centre.xy;
  depth[pixel] = valid ? z : 0.0;
  points[pixel] = valid ? vec4(ray * z, z, 1.0) : vec4(0.0);
}

void main() {
  uint pixels = uint(params.size.x * params.size.y);
  uint first = 2u * gl_GlobalInvocationID.x;
  if (first >= pixels) return;
  uint pair = raw[gl_GlobalInvocationID.x];
  convert(first, pair & 0xFFFFu);
  if (first + 1u < pixels) convert(first + 1u, pair >> 16);
}
