#version 450
#extension GL_GOOGLE_include_directive : require
// Every particle's summed loss over a slice of the selected points [eq:normallh]: one invocation per particle and
// slice. A particle is the swarm centre moved by its scaled template entry [sec:pfopst].
#include "shaders/compute/interface/fitness.h"

#define VOLUME_ACCESS readonly
#define VOLUME_LAYOUT kFitnessBindLayout
#define VOLUME_TABLE kFitnessBindTable
#define VOLUME_TSDF kFitnessBindTsdf
#include "shaders/compute/lib/compensated_sum.glsl"
#include "shaders/compute/lib/in_image.glsl"
#include "shaders/compute/lib/pose.glsl"
#include "shaders/compute/lib/volume.glsl"

layout(constant_id = 1) const uint kLoss = kLossSquared;
layout(constant_id = 2) const bool kCompensate = true;
layout(constant_id = 3) const bool kOverlapPerParticle = false;

layout(local_size_x = kFitnessGroup) in;
layout(push_constant) uniform Push { FitnessParams params; };
layout(std430, binding = kFitnessBindTemplates) readonly restrict buffer Templates { vec4 templates[]; };
layout(std430, binding = kFitnessBindPoints) readonly restrict buffer Points { vec4 points[]; };
layout(std430, binding = kFitnessBindCount) readonly restrict buffer Count { uint count[]; };
layout(std430, binding = kFitnessBindPartial) writeonly restrict buffer Partial { vec4 partial[]; };
layout(std430, binding = kFitnessBindOverlap) readonly restrict buffer Overlap { OverlapView overlap; };

void main() {
  // One invocation carries several particles, so that a point is fetched once for all of them.
  uint share = (params.particles + kFitnessParticles - 1u) / kFitnessParticles;
  uint first = gl_GlobalInvocationID.x;
  if (first >= share) return;
  mat3 rotation[kFitnessParticles];
  vec3 translation[kFitnessParticles];
  mat3 image_rotation[kFitnessParticles];
  vec3 image_translation[kFitnessParticles];
  CompensatedSum loss[kFitnessParticles];
  float counted[kFitnessParticles];
  for (uint k = 0u; k < kFitnessParticles; ++k) {
    // Past the end the last particle is repeated and its result dropped.
    uint entry = 2u * (params.first_particle + min(first + k * share, params.particles - 1u));
    vec4 turn = quaternionOf(templates[entry + 1u].xyz * params.rotation_lengths.xyz);
    vec3 shift = templates[entry].xyz * params.translation_lengths.xyz;
    rotation[k] = rotationOf(turn) * mat3(params.world_from_camera);
    translation[k] = params.world_from_camera[3].xyz + shift;
    if (kOverlapPerParticle) {
      image_rotation[k] = mat3(overlap.image_from_world) * rotation[k];
      image_translation[k] = (overlap.image_from_world * vec4(translation[k], 1.0)).xyz;
    }
    // From metres in the camera to voxels from the page table's corner.
    rotation[k] *= volume.scale.y;
    translation[k] = translation[k] * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);
    loss[k] = CompensatedSum(0.0, 0.0);
    counted[k] = 0.0;
  }

  uint total = count[0];
  uint slice = gl_WorkGroupID.y;
  uint begin = total * slice / params.slices, end = total * (slice + 1u) / params.slices;
  for (uint i = begin; i < end; ++i) {
    vec3 point = points[i].xyz;
    for (uint k = 0u; k < kFitnessParticles; ++k) {
      float psi = tsdfNearest(rotation[k] * point + translation[k]);
      float term = kLoss == kLossSquared ? psi * psi : abs(psi);
      if (kOverlapPerParticle) {
        bool counts = inImage(image_rotation[k] * point + image_translation[k], overlap.size.xy);
        term = counts ? term : 0.0;
        counted[k] += counts ? 1.0 : 0.0;
      }
      if (kCompensate) add(loss[k], term);
      else loss[k].sum += term;
    }
  }
  for (uint k = 0u; k < kFitnessParticles; ++k) {
    uint particle = first + k * share;
    float points_counted = kOverlapPerParticle ? counted[k] : float(end - begin);
    if (particle < params.particles)
      partial[slice * params.particles + particle] = vec4(loss[k].sum, loss[k].lost, points_counted, 0.0);
  }
}
