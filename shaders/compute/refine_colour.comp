#version 450
#extension GL_GOOGLE_include_directive : require
// Normal equations of the difference in luminance between the selected points' pixels and the model, at several candidate
// poses; robust. What depth leaves open, such as a shift along a flat wall, the wall's pattern may hold. The frame's brightness
// against the model's is an unknown of its own, since cameras change their exposure.
#include "shaders/compute/interface/refine_colour.h"

#define VOLUME_UNIFORM_LAYOUT kRefineColourBindLayout
#define VOLUME_TABLE kRefineColourBindTable
#define VOLUME_COLOUR kRefineColourBindColour
#define VOLUME_COLOUR_QUADS
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"

#include "shaders/compute/lib/interpolate.glsl"

#define SUMS kRefineColourSums
#define GROUP kRefineColourGroup
#define UNKNOWNS kRefineColourUnknowns
#define HESSIAN kRefineColourHessian
#define GRADIENT kRefineColourGradient
#include "shaders/compute/lib/normal_equations.glsl"

layout(local_size_x = kRefineColourGroup) in;
PUSHED_PARAMETERS(RefineColourParams)
READ_VECTORS(pointAt, kRefineColourBindPoints)
layout(std430, binding = kRefineColourBindCount) readonly restrict buffer Count { uint count[]; };
READ_WORDS(imageAt, kRefineColourBindImage)
#ifdef READ_TEXELS
READ_VECTORS(candidateRow, kRefineColourBindCandidates)
RefineColourCandidate candidateAt(uint i) {
  mat4 pose = mat4(candidateRow(5u * i), candidateRow(5u * i + 1u), candidateRow(5u * i + 2u), candidateRow(5u * i + 3u));
  return RefineColourCandidate(pose, candidateRow(5u * i + 4u));
}
#else
layout(std430, binding = kRefineColourBindCandidates) readonly restrict buffer Candidates { RefineColourCandidate candidates[]; };
RefineColourCandidate candidateAt(uint i) { return candidates[i]; }
#endif
layout(std430, binding = kRefineColourBindSums) writeonly restrict buffer Sums { float sums[]; };

// The pixel that the point was made of.
uint pixelOf(vec3 p) {
  ivec2 uv = ivec2(floor(params.focal_centre.xy * p.xy / p.z + params.focal_centre.zw + 0.5));
  uv = clamp(uv, ivec2(0), params.size.xy - 1);
  return uint(uv.y * params.size.x + uv.x);
}

void main() {
  uint lane = gl_LocalInvocationID.x, part = gl_WorkGroupID.x, number = gl_WorkGroupID.y;
  RefineColourCandidate candidate = candidateAt(number);
  mat3 turn = mat3(candidate.world_from_camera);
  vec3 shift = candidate.world_from_camera[3].xyz * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);
  vec3 last = vec3(volume.table_size.xyz * kBlockSide) - 3.0;
  float gain = candidate.gain.x;
  DECLARE_SUMS

  uint total = count[0];
  uint begin = total * part / params.parts, end = total * (part + 1u) / params.parts;
  uint i = begin + lane;
  if (i < end) do {
    vec3 p = pointAt(i).xyz;
    vec3 arm = turn * p;
    // Outside the table the border blocks are read, which have no colour.
    Luminance model = luminanceAt(clamp(arm * volume.scale.y + shift, vec3(2.0), last));
    if (!model.known) continue;
    float residual = gain * model.value - luminanceOf(imageAt(pixelOf(p)));
    float size = abs(residual);
    vec3 slope = model.gradient * (gain * volume.scale.y);
    vec3 moment = cross(arm, slope);
    float jacobian[kRefineColourUnknowns] = float[kRefineColourUnknowns](slope.x, slope.y, slope.z, moment.x, moment.y, moment.z,
                                                                         model.value);
    float weight = min(1.0, params.huber / max(size, 1e-9));
    ADD_EQUATION(jacobian, weight, residual)
    accumulate(sum[kRefineColourCost], size <= params.huber ? 0.5 * size * size : params.huber * (size - 0.5 * params.huber));
    accumulate(sum[kRefineColourPoints], 1.0);
  } while ((i += kRefineColourGroup) < end);

  WRITE_SUMS(lane, (number * params.parts + part) * kRefineColourSums)
}
