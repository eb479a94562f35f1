#include "host/swarm/swarm_update.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rosefusion {
namespace {

// (w, v) of the unit quaternion with imaginary part v; |v| > 1 becomes a half turn about v.
Eigen::Vector4d unitQuaternion(Eigen::Vector3d v) {
  const double squared = v.squaredNorm();
  if (squared > 1) v /= std::sqrt(squared);
  Eigen::Vector4d q;
  q << std::sqrt(std::max(0.0, 1 - squared)), v;
  return q;
}

bool isCounted(const SwarmSettings& settings, std::span<const float> losses,
               std::span<const uint32_t> pixel_counts, size_t i) {
  if (!(losses[i] >= 0)) return false;  // NaN too
  return pixel_counts.empty() || i == 0 ||
         pixel_counts[i] > settings.minimum_counted_share * static_cast<double>(pixel_counts[0]);
}

double fitnessOf(const SwarmSettings& settings, double loss) {
  return settings.loss == FitnessLoss::Squared ? std::exp(-loss / settings.tau) : 1 - loss;
}

// The advantage set's weighted mean [eq. ebs] and its approximated fitness [eq. wafit].
struct AdvantageMean {
  int count = 0;
  Vector6 move = Vector6::Zero();
  double likelihood = 0;
};

AdvantageMean averageAdvantage(const SwarmSettings& settings, const SwarmState& state,
                               const SwarmTemplate& swarm_template, std::span<const float> losses,
                               std::span<const uint32_t> pixel_counts, double reference) {
  AdvantageMean mean;
  double weight_sum = 0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();
  for (size_t i = 1; i < swarm_template.particles.size(); ++i) {
    // Most particles are worse, which their loss tells without its fitness.
    if (!(losses[i] < losses[0]) || !isCounted(settings, losses, pixel_counts, i)) continue;
    const double score = fitnessOf(settings, losses[i]);
    if (!(score > reference)) continue;
    const double weight = score - reference;
    const Vector6 particle = scaledParticle(swarm_template, i, state.axis_lengths);
    weight_sum += weight;
    translation += weight * particle.head<3>();
    // Whole quaternions are averaged: the result then does not depend on the frame they are expressed in, so
    // that averaging moves is the same as averaging poses.
    quaternion += weight * unitQuaternion(particle.tail<3>());
    mean.likelihood += weight * score;
    if (++mean.count == settings.max_advantage_particles) break;
  }
  if (mean.count == 0) return mean;
  mean.likelihood /= weight_sum;
  mean.move << translation / weight_sum, quaternion.normalized().tail<3>();
  return mean;
}

// r^ after a successful iteration [eq. rsinter]. Lengths are magnitudes, whatever the move's direction.
Vector6 attractedLengths(const SwarmSettings& settings, const Vector6& move, double likelihood) {
  const double norm = move.norm();
  const bool directed = norm > 0 && settings.rescaling != Rescaling::Isotropic;
  const Vector6 direction =
      directed ? Vector6(move.cwiseAbs() / norm) : Vector6(Vector6::Ones().normalized());
  if (settings.rescaling == Rescaling::Anisotropic) likelihood = settings.initial_likelihood;
  return (settings.axis_scale * (1 - likelihood) * direction).array() + settings.axis_epsilon;
}

Vector6 initialLengths(const SwarmSettings& settings, double loss) {
  return Vector6::Constant(settings.first_axis_scale * loss);
}

StopReason stopReason(const SwarmSettings& settings, const SwarmState& state, const SwarmStep& step) {
  if (state.empty_sets_in_a_row >= settings.max_empty_sets) return StopReason::EmptySets;
  if (step.advantage > 0 && step.move.cwiseAbs().maxCoeff() < settings.minimum_move)
    return StopReason::SmallMove;
  if (state.iteration >= settings.max_iterations) return StopReason::MaxIterations;
  return StopReason::None;
}

}  // namespace

std::optional<double> particleFitness(const SwarmSettings& settings, std::span<const float> losses,
                                      std::span<const uint32_t> pixel_counts, size_t i) {
  if (!isCounted(settings, losses, pixel_counts, i)) return std::nullopt;
  return fitnessOf(settings, losses[i]);
}

SwarmState beginFrame(const SwarmSettings& settings, const Pose& start, const SwarmState* previous_frame) {
  SwarmState state;
  state.centre = start;
  state.best_likelihood = settings.initial_likelihood;
  state.failure_loss = previous_frame ? previous_frame->failure_loss : 1 - settings.initial_likelihood;
  state.serial = previous_frame ? previous_frame->serial : 0;
  state.axis_lengths = previous_frame && settings.frame_start == FrameStart::PreviousFirstLengths
                           ? previous_frame->first_axis_lengths
                           : initialLengths(settings, state.failure_loss);
  state.first_axis_lengths = state.axis_lengths;
  return state;
}

Pose moveBy(const Pose& centre, const Vector6& move) {
  const Eigen::Vector4d q = unitQuaternion(move.tail<3>());
  return moved(centre, move.head<3>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
}

Vector6 scaledParticle(const SwarmTemplate& swarm_template, size_t index, const Vector6& axis_lengths) {
  return Eigen::Map<const Eigen::Matrix<float, 6, 1>>(swarm_template.particles[index].data())
      .cast<double>()
      .cwiseProduct(axis_lengths);
}

Eigen::Vector2i pixelOffset(const SwarmSettings& settings, const SwarmState& state) {
  const auto stride = static_cast<uint64_t>(settings.levels[state.level].pixel_stride);
  const auto shift = static_cast<uint64_t>(settings.pixel_shift);
  return {static_cast<int>(state.serial * shift % stride),
          static_cast<int>((state.serial + state.serial / stride) * shift % stride)};
}

SwarmStep update(const SwarmSettings& settings, SwarmState& state, const SwarmTemplate& swarm_template,
                 std::span<const float> losses, std::span<const uint32_t> pixel_counts) {
  if (losses.size() != swarm_template.particles.size() || losses.empty() ||
      (!pixel_counts.empty() && pixel_counts.size() != losses.size()))
    throw std::invalid_argument("swarm update: one loss (and pixel count) per particle is needed");
  if (state.stopped()) throw std::invalid_argument("swarm update: the search has stopped");

  const std::optional<double> reference = particleFitness(settings, losses, pixel_counts, 0);
  SwarmStep step;
  step.level = state.level;
  for (size_t i = 0; i < losses.size(); ++i) step.counted += isCounted(settings, losses, pixel_counts, i);

  AdvantageMean mean;
  if (reference) mean = averageAdvantage(settings, state, swarm_template, losses, pixel_counts, *reference);
  Vector6 lengths;
  if (mean.count > 0) {
    state.centre = moveBy(state.centre, mean.move);
    lengths = attractedLengths(settings, mean.move, mean.likelihood);
  } else if (reference) {
    const double isotropic = 1 / std::sqrt(6.0);  // v / |v| of v = ones
    lengths = Vector6::Constant(settings.empty_set_scale * (1 - *reference) * isotropic);
  } else {
    lengths = initialLengths(settings, 1 - settings.initial_likelihood);
  }
  step.advantage = mean.count;
  step.move = mean.move;
  step.likelihood_before = reference.value_or(settings.initial_likelihood);
  step.likelihood_after = mean.count > 0 ? mean.likelihood : step.likelihood_before;
  finishIteration(settings, state, step);
  state.axis_lengths = settings.axis_momentum * state.axis_lengths + (1 - settings.axis_momentum) * lengths;
  if (state.iteration == 1) state.first_axis_lengths = state.axis_lengths;
  step.axis_lengths = state.axis_lengths;
  return step;
}

void finishIteration(const SwarmSettings& settings, SwarmState& state, SwarmStep& step) {
  step.iteration = ++state.iteration;
  state.best_likelihood = step.likelihood_after;
  const bool empty = step.advantage == 0;
  state.empty_sets_in_a_row = empty ? state.empty_sets_in_a_row + 1 : 0;
  if (empty && !state.had_empty_set) state.failure_loss = 1 - step.likelihood_before;
  state.had_empty_set = state.had_empty_set || empty;
  ++state.serial;
  const bool restart = empty && settings.restart_levels_when_empty;
  state.level = restart ? 0 : (state.level + 1) % settings.levels.size();
  step.stop_reason = state.stop_reason = stopReason(settings, state, step);
}

}  // namespace rosefusion
