#version 450
#extension GL_GOOGLE_include_directive : require
// Normal equations of the distance between the selected points and the model's surface (trilinear TSDF value, smooth
// gradient) at several candidate poses; robust and weighted by the noise of sensor and model. One workgroup per candidate and
// part of the points; all sums compensated.
#include "shaders/compute/interface/refine.h"

#define VOLUME_UNIFORM_LAYOUT kRefineBindLayout
#define VOLUME_TABLE kRefineBindTable
#define VOLUME_TSDF kRefineBindTsdf
#define VOLUME_TSDF_QUADS
#define VOLUME_WEIGHT kRefineBindWeight
#include "shaders/compute/lib/depth_noise.glsl"
#include "shaders/compute/lib/in_image.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/volume.glsl"

#include "shaders/compute/lib/interpolate.glsl"

#define SUMS kRefineSums
#define GROUP kRefineGroup
#define UNKNOWNS 6u
#define HESSIAN kRefineHessian
#define GRADIENT kRefineGradient
#include "shaders/compute/lib/normal_equations.glsl"

layout(local_size_x = kRefineGroup) in;
PUSHED_PARAMETERS(RefineParams)
READ_VECTORS(pointAt, kRefineBindPoints)
layout(std430, binding = kRefineBindCount) readonly restrict buffer Count { uint count[]; };
#ifdef READ_TEXELS
READ_VECTORS(candidateRow, kRefineBindCandidates)
mat4 candidateMatrix(uint i) {
  return mat4(candidateRow(4u * i), candidateRow(4u * i + 1u), candidateRow(4u * i + 2u), candidateRow(4u * i + 3u));
}
RefineCandidate candidateAt(uint i) { return RefineCandidate(candidateMatrix(2u * i), candidateMatrix(2u * i + 1u)); }
#else
layout(std430, binding = kRefineBindCandidates) readonly restrict buffer Candidates { RefineCandidate candidates[]; };
RefineCandidate candidateAt(uint i) { return candidates[i]; }
#endif
layout(std430, binding = kRefineBindSums) writeonly restrict buffer Sums { float sums[]; };

const float kBackCosine = 0.2;   // grazing surfaces are noise on either side of 0
const float kCloseDeviations = 2.0;
const float kTruncated = 0.999;  // of a stored value: beyond, the voxel tells no distance

float robust(float distance_) {
  float a = abs(distance_);
  return a <= params.huber ? 0.5 * a * a : params.huber * (a - 0.5 * params.huber);
}

float modelWeight(vec3 position) {
  ivec3 voxel = ivec3(position);
  return max(weightInBlock(slotAt(voxel >> 3), localIndex(voxel)), 1.0 / kWeightOne);
}

void main() {
  uint lane = gl_LocalInvocationID.x, part = gl_WorkGroupID.x, number = gl_WorkGroupID.y;
  RefineCandidate candidate = candidateAt(number);
  mat3 turn = mat3(candidate.world_from_camera);
  mat4 last_image = candidate.last_image_from_camera;
  vec3 shift = candidate.world_from_camera[3].xyz * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);
  vec3 last = vec3(volume.table_size.xyz * kBlockSide) - 3.0;
  float truncation = volume.scale.z;
  float most = robust(truncation);  // cost of a point that finds no surface
  DECLARE_SUMS

  uint total = count[0];
  uint begin = total * part / params.parts, end = total * (part + 1u) / params.parts;
  uint i = begin + lane;
  if (i < end) do {
    vec3 p = pointAt(i).xyz;
    vec3 arm = turn * p;
    float noise = depthNoise(params.noise_floor, params.noise_growth, p.z);
    float variance = depthVariance(noise, params.bias_growth, p.z);
    // Outside the table the border blocks are read, which hold no distance.
    vec3 position = clamp(arm * volume.scale.y + shift, vec3(2.0), last);
    Neighbourhood near = neighbourhoodOf(position);
    bool usable = near.largest_in_cell < kTruncated;
    if (usable) variance += params.model_noise * params.model_noise / modelWeight(position);
    // Poses are told apart by how much of the image they explain: in the cost, noise matters only beyond huber.
    float cost_weight = 1.0 / (1.0 + variance / (params.huber * params.huber));
    float weight = params.noise_floor * params.noise_floor / variance;
    float residual = near.value * truncation;
    // A thin wall's other side, seen before, would pull the point through the wall.
    if (usable && params.front_only != 0u && near.largest < kTruncated &&
        dot(near.gradient, arm) > kBackCosine * length(near.gradient) * length(arm)) continue;
    if (!usable && !inImage((last_image * vec4(p, 1.0)).xyz, ivec2(params.last_image.xy), params.last_image.z)) continue;
    accumulate(sum[kRefineMostCost], cost_weight * most);
    accumulate(sum[kRefineCost], cost_weight * (usable ? robust(residual) : most));
    if (!usable) continue;
    accumulate(sum[kRefineCostWeight], cost_weight);
    accumulate(sum[kRefineUsable], 1.0);
    accumulate(sum[kRefineRows], p.y / p.z);
    accumulate(sum[kRefineClose], abs(residual) < max(params.huber, kCloseDeviations * noise) ? 1.0 : 0.0);
    // Beside what was not observed the step to there would look like a slope.
    if (near.largest >= kTruncated) continue;
    // The smooth gradient: that of a cell alone is so noisy that a flat wall seems to hold shifts along it.
    vec3 slope = near.gradient * (truncation * volume.scale.y);
    vec3 moment = cross(arm, slope);
    float jacobian[6] = float[6](slope.x, slope.y, slope.z, moment.x, moment.y, moment.z);
    weight *= min(1.0, params.huber / max(abs(residual), 1e-9));
    ADD_EQUATION(jacobian, weight, residual)
  } while ((i += kRefineGroup) < end);

  WRITE_SUMS(lane, (number * params.parts + part) * kRefineSums)
}
