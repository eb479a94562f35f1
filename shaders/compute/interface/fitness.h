// Pass fitness: every particle's summed loss over a slice of the selected points [eq:normallh].
#ifndef ROSEFUSION_INTERFACE_FITNESS_H
#define ROSEFUSION_INTERFACE_FITNESS_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kFitnessGroup = 64u;     // invocations per workgroup; the y index is the slice of points
const uint kFitnessParticles = 4u;  // particles per invocation
// Racing: the points are walked in rounds spread over the image, at most so many and none shorter.
const uint kRaceRounds = 8u;
const uint kRaceRoundPoints = 32u;
const uint kFitnessBindLayout = 0u;
const uint kFitnessBindTable = 1u;
const uint kFitnessBindTsdf = 2u;  // kMaxPoolChunks bindings
const uint kFitnessBindTemplates =
    6u;  // two vec4 per particle: (x, y, z, 0), (qx, qy, qz, 0) in the unit ball
const uint kFitnessBindPoints = 7u;
const uint kFitnessBindCount = 8u;
const uint kFitnessBindPartial =
    9u;  // vec4 per slice and particle: sum, compensation, points counted, points walked
const uint kFitnessBindOverlap = 10u;  // OverlapView; read only with per-particle overlap
const uint kFitnessBindings = 11u;
const uint kLossSquared = 0u;   // psi^2: the paper
const uint kLossAbsolute = 1u;  // |psi|

struct OverlapView {
  mat4 image_from_world;  // world point -> (u z, v z, z) in the last frame's camera
  ivec4 size;             // width, height of its image
};

struct FitnessParams {
  mat4 world_from_camera;    // the swarm centre
  vec4 translation_lengths;  // axis lengths of the swarm, metres
  vec4 rotation_lengths;     // of the quaternion's imaginary part
  uint particles;
  uint first_particle;  // of the template, in the template buffer
  uint slices;
  float race_margin;  // a particle is given up when its mean loss over n points exceeds particle 0's by this
                      // / sqrt(n)
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
