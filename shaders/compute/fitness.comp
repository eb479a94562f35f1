#version 450
#extension GL_GOOGLE_include_directive : require
// Every particle's summed loss over a slice of the selected points [eq:normallh]: one invocation per particle and
// slice. A particle is the swarm centre moved by its scaled template entry [sec:pfopst].
#include "shaders/compute/interface/fitness.h"

#define VOLUME_UNIFORM_LAYOUT kFitnessBindLayout
#define VOLUME_TABLE kFitnessBindTable
#define VOLUME_TSDF kFitnessBindTsdf
#include "shaders/compute/lib/compensated_sum.glsl"
#include "shaders/compute/lib/in_image.glsl"
#include "shaders/compute/lib/parameters.glsl"
#include "shaders/compute/lib/pose.glsl"
#include "shaders/compute/lib/volume.glsl"

layout(constant_id = 1) const uint kLoss = kLossSquared;
layout(constant_id = 2) const bool kCompensate = true;
layout(constant_id = 3) const bool kOverlapPerParticle = false;
layout(constant_id = 4) const bool kRace = false;

layout(local_size_x = kFitnessGroup) in;
PUSHED_PARAMETERS(FitnessParams)
READ_VECTORS(templateAt, kFitnessBindTemplates)
READ_VECTORS(pointAt, kFitnessBindPoints)
layout(std430, binding = kFitnessBindCount) readonly restrict buffer Count { uint count[]; };
layout(std430, binding = kFitnessBindPartial) writeonly restrict buffer Partial { vec4 partial[]; };
UNIFORM_PARAMETERS(OverlapView, overlap, kFitnessBindOverlap)

// A particle's way from the camera to voxels from the page table's corner, and to the last frame's image.
struct Candidate {
  mat3 rotation;
  vec3 translation;
  mat3 image_rotation;
  vec3 image_translation;
};

Candidate candidate(uint particle) {
  uint entry = 2u * (params.first_particle + particle);
  vec4 turn = quaternionOf(templateAt(entry + 1u).xyz * params.rotation_lengths.xyz);
  vec3 shift = templateAt(entry).xyz * params.translation_lengths.xyz;
  Candidate c;
  c.rotation = rotationOf(turn) * mat3(params.world_from_camera);
  c.translation = params.world_from_camera[3].xyz + shift;
  if (kOverlapPerParticle) {
    c.image_rotation = mat3(overlap.image_from_world) * c.rotation;
    c.image_translation = (overlap.image_from_world * vec4(c.translation, 1.0)).xyz;
  }
  c.rotation *= volume.scale.y;
  c.translation = c.translation * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);
  return c;
}

bool counts(Candidate c, vec3 point) {
  return !kOverlapPerParticle || inImage(c.image_rotation * point + c.image_translation, overlap.size.xy, 0.0);
}

float term(Candidate c, vec3 point) {
  float psi = tsdfNearest(c.rotation * point + c.translation);
  return kLoss == kLossSquared ? psi * psi : abs(psi);
}

void main() {
  // One invocation carries several particles, so that a point is fetched once for all of them.
  uint share = (params.particles + kFitnessParticles - 1u) / kFitnessParticles;
  uint first = gl_GlobalInvocationID.x;
  if (first >= share) return;
  Candidate candidates[kFitnessParticles];
  CompensatedSum loss[kFitnessParticles];
  float counted[kFitnessParticles];
  for (uint k = 0u; k < kFitnessParticles; ++k) {
    // Past the end the last particle is repeated and its result dropped.
    candidates[k] = candidate(min(first + k * share, params.particles - 1u));
    loss[k] = CompensatedSum(0.0, 0.0);
    counted[k] = 0.0;
  }
  Candidate centre;  // particle 0, which the others race against
  float centre_loss = 0.0, centre_counted = 0.0;
  if (kRace) centre = candidate(0u);

  uint total = count[0];
  uint slice = gl_WorkGroupID.y;
  uint begin = total * slice / params.slices, end = total * (slice + 1u) / params.slices;
  uint rounds = kRace ? clamp((end - begin) / kRaceRoundPoints, 1u, kRaceRounds) : 1u;
  float walked = 0.0;
  bool given_up = false;
  for (uint round = 0u; round < rounds && !given_up; ++round) {
    for (uint i = begin + round; i < end; i += rounds) {
      vec3 point = pointAt(i).xyz;
      for (uint k = 0u; k < kFitnessParticles; ++k) {
        float value = term(candidates[k], point);
        if (kOverlapPerParticle) {
          bool here = counts(candidates[k], point);
          value = here ? value : 0.0;
          counted[k] += here ? 1.0 : 0.0;
        }
        if (kCompensate) add(loss[k], value);
        else loss[k].sum += value;
      }
      if (kRace) {
        bool here = counts(centre, point);
        centre_loss += here ? term(centre, point) : 0.0;
        centre_counted += here ? 1.0 : 0.0;
        walked += 1.0;
      }
    }
    if (kRace) {
      float bound = centre_loss / centre_counted + params.race_margin * inversesqrt(centre_counted);
      given_up = centre_counted > 0.0;
      for (uint k = 0u; k < kFitnessParticles; ++k) {
        float points_counted = kOverlapPerParticle ? counted[k] : walked;
        given_up = given_up && loss[k].sum > bound * points_counted;
      }
    }
  }
  for (uint k = 0u; k < kFitnessParticles; ++k) {
    uint particle = first + k * share;
    if (!kRace) walked = float(end - begin);
    float points_counted = given_up ? 0.0 : kOverlapPerParticle ? counted[k] : walked;
    if (particle < params.particles)
      partial[slice * params.particles + particle] = vec4(loss[k].sum, loss[k].lost, points_counted, walked);
  }
}
