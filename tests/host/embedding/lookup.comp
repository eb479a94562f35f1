#version 450
#extension GL_GOOGLE_include_directive : require
// An application's own shader: reads the model at given places through the library's lookup. For test_vulkan.cpp.
#define VOLUME_LAYOUT 0
#define VOLUME_TABLE 1
#define VOLUME_TSDF 2
#define VOLUME_WEIGHT 6
#include "shaders/compute/lib/volume.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = 10) readonly buffer Points { vec4 points[]; };      // world, metres
layout(std430, binding = 11) writeonly buffer Distances { float distances[]; };  // TSDF, 1 where unobserved

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= points.length()) return;
  distances[i] = tsdfNearest(points[i].xyz * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide));
}
