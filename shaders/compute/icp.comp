#version 450
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// Normal equations of the point-to-plane distance between the frame's points and the surface that the last frame's camera
// sees in the model: pairs by projection into that view, gated by distance and normals (the recipe of KinectFusion). One
// workgroup per part of the pixels; all sums compensated.
#include "shaders/compute/interface/icp.h"
#include "shaders/compute/lib/direction.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/read.glsl"

#define SUMS kIcpSums
#define GROUP kIcpGroup
#define UNKNOWNS 6u
#define HESSIAN kIcpHessian
#define GRADIENT kIcpGradient
#include "shaders/compute/lib/normal_equations.glsl"

layout(local_size_x = kIcpGroup) in;
PUSHED_PARAMETERS(IcpParams)
READ_VECTORS(pointOf, kIcpBindPoints)
READ_WORDS(modelSurface, kIcpBindSurface)
UNIFORM_PARAMETERS(IcpModel, model, kIcpBindModel)
layout(std430, binding = kIcpBindSums) writeonly restrict buffer Sums { float sums[]; };

vec4 pointAt(ivec2 at) {
  bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, model.size.xy));
  return inside ? pointOf(uint(at.y * model.size.x + at.x)) : vec4(0.0);
}

// Towards the camera, in its frame; 0 where a neighbour is missing or lies on another surface.
vec3 normalOf(ivec2 at, vec3 p) {
  vec4 left = pointAt(at - ivec2(kIcpReach, 0)), right = pointAt(at + ivec2(kIcpReach, 0));
  vec4 up = pointAt(at - ivec2(0, kIcpReach)), down = pointAt(at + ivec2(0, kIcpReach));
  if (min(min(left.w, right.w), min(up.w, down.w)) == 0.0) return vec3(0.0);
  vec4 apart = vec4(distance(left.xyz, p), distance(right.xyz, p), distance(up.xyz, p), distance(down.xyz, p));
  if (max(max(apart.x, apart.y), max(apart.z, apart.w)) > model.distance) return vec3(0.0);
  vec3 n = cross(right.xyz - left.xyz, down.xyz - up.xyz);
  return normalize(dot(n, p) > 0.0 ? -n : n);
}

void main() {
  uint lane = gl_LocalInvocationID.x, part = gl_WorkGroupID.x;
  DECLARE_SUMS

  uint cells = uint(model.grid.z * model.grid.w), each = (cells + params.parts - 1u) / params.parts;
  uint begin = each * part, end = min(begin + each, cells);
  uint cell = begin + lane;
  if (cell < end) do {
    ivec2 at = ivec2(cell % uint(model.grid.z), cell / uint(model.grid.z)) * model.grid.x + model.grid.y;
    vec4 p = pointAt(at);
    if (p.w == 0.0) continue;
    vec3 arm = mat3(params.world_from_camera) * p.xyz;
    vec3 point = arm + params.world_from_camera[3].xyz;
    vec3 seen = (model.camera_from_world * vec4(point, 1.0)).xyz;
    if (seen.z <= 0.0) continue;
    vec2 image = floor(model.focal_centre.xy * seen.xy / seen.z + model.focal_centre.zw + 0.5);
    if (any(lessThan(image, vec2(0.0))) || any(greaterThanEqual(image, vec2(model.size.xy)))) continue;
    uint pixel = uint(int(image.y) * model.size.x + int(image.x));
    float depth = uintBitsToFloat(modelSurface(2u * pixel + 1u));
    vec3 vertex = depth * vec3((image - model.focal_centre.zw) / model.focal_centre.xy, 1.0);
    vec3 to_model = (vertex - seen) * mat3(model.camera_from_world);  // in the world's axes: by the transpose
    if (depth == 0.0 || dot(to_model, to_model) > model.distance * model.distance) continue;
    vec3 n = unpackedDirection(modelSurface(2u * pixel)), own = normalOf(at, p.xyz);
    if (dot(mat3(params.world_from_camera) * own, n) < model.cosine || dot(own, own) == 0.0) continue;
    float residual = -dot(n, to_model);
    vec3 moment = cross(arm, n);
    float jacobian[6] = float[6](n.x, n.y, n.z, moment.x, moment.y, moment.z);
    ADD_EQUATION(jacobian, 1.0, residual)
    accumulate(sum[kIcpSquares], residual * residual);
    accumulate(sum[kIcpPairs], 1.0);
  } while ((cell += kIcpGroup) < end);

  WRITE_SUMS(lane, part * kIcpSums)
}
