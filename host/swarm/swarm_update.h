// The pose search's update: from the particles' losses to the next centre and axis lengths of the swarm.
// Pure, in double precision; whoever evaluates the losses is not known here.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "host/core/camera.h"
#include "host/swarm/swarm_settings.h"
#include "host/swarm/template_sampling.h"

namespace rosefusion {

/// Why a frame's search has ended: max_empty_sets without a better particle, a negligible move,
/// max_iterations.
enum class StopReason { None, EmptySets, SmallMove, MaxIterations };

/// The search for one frame's pose. Read it, let beginFrame and update change it.
struct SwarmState {
  Pose centre = Pose::Identity();          ///< s*: best pose so far, world_from_camera
  Vector6 axis_lengths = Vector6::Zero();  ///< r: the template's scale on each axis
  double best_likelihood = 0;              ///< rho(s*), in [0, 1]
  int iteration = 0;                       ///< finished iterations of this frame
  int empty_sets_in_a_row = 0;
  size_t level = 0;     ///< of SwarmSettings::levels, for the next iteration
  uint64_t serial = 0;  ///< iterations since the first frame: number of the next template
  Vector6 first_axis_lengths = Vector6::Zero();  ///< r1 of this frame, seeds the next one
  bool had_empty_set = false;                    ///< in this frame
  double failure_loss = 0;  ///< 1 - rho at the first empty set of the latest frame that had one (FailureLoss)
  StopReason stop_reason = StopReason::None;

  bool stopped() const { return stop_reason != StopReason::None; }
};

/// What one iteration did, for logs and plots.
struct SwarmStep {
  int iteration = 0;                       ///< from 1
  size_t level = 0;                        ///< the level evaluated
  int counted = 0;                         ///< particles with a valid loss
  int advantage = 0;                       ///< particles averaged; 0 when the advantage set was empty
  double likelihood_before = 0;            ///< of particle 0, under this iteration's pixels
  double likelihood_after = 0;             ///< approximated [eq. wafit]; as before when the set was empty
  Vector6 move = Vector6::Zero();          ///< v [eq. rsdir]
  Vector6 axis_lengths = Vector6::Zero();  ///< r for the next iteration
  StopReason stop_reason = StopReason::None;
};

/// Starts at `start` (usually the last frame's pose) with the lengths of the last frame's first iteration, or
/// with a sphere when there is no last frame (nullptr) [PST initialization].
SwarmState beginFrame(const SwarmSettings& settings, const Pose& start, const SwarmState* previous_frame);

/// The pose `centre` moved by a scaled particle: translation added, rotation (sqrt(1 - |v|^2), v) applied
/// from the left, so that the camera turns about its own centre; |v| > 1 is clamped to a half turn. The
/// shaders' twin of this formula lives in shaders/compute/lib.
Pose moveBy(const Pose& centre, const Vector6& move);

/// Particle `index` scaled by the axis lengths.
Vector6 scaledParticle(const SwarmTemplate& swarm_template, size_t index, const Vector6& axis_lengths);

/// First pixel (x, y) of the sampled grid, each in [0, stride): moves by pixel_shift each iteration, and one
/// more step in y each time x comes round, so that every pixel gets its turn.
Eigen::Vector2i pixelOffset(const SwarmSettings& settings, const SwarmState& state);

/// One iteration [Algorithm 1]. losses[i]: mean of psi^2 or |psi| (psi in [-1, 1], see FitnessLoss) of
/// particle i over its counted pixels, in [0, 1]; NaN or negative = not counted. pixel_counts (optional, else
/// empty): counted pixels of particle i, for minimum_counted_share. Particle 0 is the zero move, so its loss
/// is the current best's under the same pixels; where it is not counted nothing can be compared and the swarm
/// becomes the initial sphere again. Throws std::invalid_argument when the spans do not have the template's
/// size or the search has stopped.
SwarmStep update(const SwarmSettings& settings, SwarmState& state, const SwarmTemplate& swarm_template,
                 std::span<const float> losses, std::span<const uint32_t> pixel_counts = {});

/// What every kind of swarm ends an iteration with: counts it, remembers whether anything improved
/// (step.advantage), chooses the next level, and decides whether the search stops. Before: step.level,
/// advantage, likelihoods and move; after: the rest but the axis lengths.
void finishIteration(const SwarmSettings& settings, SwarmState& state, SwarmStep& step);

/// Fitness of particle `i` in [0, 1], none where it does not count; see update for the arguments.
std::optional<double> particleFitness(const SwarmSettings& settings, std::span<const float> losses,
                                      std::span<const uint32_t> pixel_counts, size_t i);

}  // namespace rosefusion
