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
#include "shaders/compute/lib/pose.glsl"
#include "shaders/compute/lib/volume.glsl"

layout(constant_id = 1) const uint kLoss = kLossSquared;
layout(constant_id = 2) const bool kCompensate = true;

layout(local_size_x = kFitnessGroup) in;
layout(push_constant) uniform Push { FitnessParams params; };
layout(std430, binding = kFitnessBindTemplates) readonly restrict buffer Templates { vec4 templates[]; };
layout(std430, binding = kFitnessBindPoints) readonly restrict buffer Points { vec4 points[]; };
layout(std430, binding = kFitnessBindCount) readonly restrict buffer Count { uint count[]; };
layout(std430, binding = kFitnessBindPartial) writeonly restrict buffer Partial { vec2 partial[]; };

void main() {
  uint particle = gl_GlobalInvocationID.x;
  if (particle >= params.particles) return;
  uint entry = 2u * (params.first_particle + particle);
  vec3 shift = templates[entry].xyz * params.translation_lengths.xyz;
  vec4 turn = quaternionOf(templates[entry + 1u].xyz * params.rotation_lengths.xyz);
  mat3 rotation = rotationOf(turn) * mat3(params.world_from_camera);
  vec3 translation = params.world_from_camera[3].xyz + shift;
  // From metres in the world to voxels from the page table's corner.
  rotation *= volume.scale.y;
  translation = translation * volume.scale.y - vec3(volume.table_origin.xyz * kBlockSide);

  uint total = count[0];
  uint slice = gl_WorkGroupID.y;
  uint begin = uint(total * slice) / params.slices, end = uint(total * (slice + 1u)) / params.slices;
  CompensatedSum loss = CompensatedSum(0.0, 0.0);
  for (uint i = begin; i < end; ++i) {
    float psi = tsdfNearest(rotation * points[i].xyz + translation);
    float term = kLoss == kLossSquared ? psi * psi : abs(psi);
    if (kCompensate) add(loss, term);
    else loss.sum += term;
  }
  partial[slice * params.particles + particle] = vec2(loss.sum, loss.lost);
}
