#include "host/slam/baselines/free_swarm.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rosefusion {
namespace {

/// Standard normal (Marsaglia's polar method).
double normal(PortableRandom& random) {
  double x, square;
  do {
    x = 2 * random.uniform() - 1;
    const double y = 2 * random.uniform() - 1;
    square = x * x + y * y;
  } while (square >= 1 || square == 0);
  return x * std::sqrt(-2 * std::log(square) / square);
}

/// That nothing improved tells of the template that it is in the optimum, but nothing of these swarms, whose
/// particles are still under way: they spend all iterations, and the levels in turn.
SwarmSettings patient(SwarmSettings settings) {
  settings.max_empty_sets = settings.max_iterations + 1;
  settings.minimum_move = 0;
  settings.restart_levels_when_empty = false;
  return settings;
}

/// The evaluated particles' fitness, below 0 where one does not count. Moves the best to the front.
std::vector<double> takeBest(const SwarmSettings& settings, FreeSwarm& swarm, std::span<const float> losses,
                             std::span<const uint32_t> pixel_counts, SwarmStep& step) {
  if (losses.size() != swarm.evaluated(settings) || losses.empty() ||
      (!pixel_counts.empty() && pixel_counts.size() != losses.size()))
    throw std::invalid_argument("free swarm: one loss (and pixel count) per evaluated particle is needed");
  if (swarm.state.stopped()) throw std::invalid_argument("free swarm: the search has stopped");
  std::vector<double> fitness;
  for (std::size_t i = 0; i < losses.size(); ++i)
    fitness.push_back(particleFitness(settings, losses, pixel_counts, i).value_or(-1));
  step.level = swarm.state.level;
  step.counted =
      static_cast<int>(std::count_if(fitness.begin(), fitness.end(), [](double f) { return f >= 0; }));
  step.likelihood_before = step.likelihood_after = fitness[0] >= 0 ? fitness[0] : settings.initial_likelihood;
  if (fitness[0] < 0) return fitness;  // nothing can be compared
  step.advantage = static_cast<int>(
      std::count_if(fitness.begin(), fitness.end(), [&](double f) { return f > fitness[0]; }));
  const auto best = std::max_element(fitness.begin(), fitness.end()) - fitness.begin();
  if (best == 0) return fitness;
  step.move = swarm.particles[best] - swarm.particles[0];
  step.likelihood_after = fitness[best];
  swarm.particles[0] = swarm.particles[best];
  swarm.state.centre = moveBy(swarm.start, swarm.particles[0]);
  return fitness;
}

}  // namespace

std::size_t FreeSwarm::evaluated(const SwarmSettings& settings) const {
  return std::min(particles.size(), static_cast<std::size_t>(settings.levels[state.level].particles));
}

FreeSwarm beginFreeSwarm(const SwarmSettings& settings, const Pose& start, const SwarmTemplate& first,
                         const SwarmState* previous_frame) {
  FreeSwarm swarm;
  swarm.state = beginFrame(settings, start, previous_frame);
  swarm.start = start;
  for (std::size_t i = 0; i < first.particles.size(); ++i)
    swarm.particles.push_back(scaledParticle(first, i, swarm.state.axis_lengths));
  swarm.velocities.assign(swarm.particles.size(), Vector6::Zero());
  swarm.own_best = swarm.particles;
  swarm.own_best_fitness.assign(swarm.particles.size(), -1);
  return swarm;
}

SwarmStep updatePfo(const SwarmSettings& settings, const PfoSettings& pfo, FreeSwarm& swarm,
                    std::span<const float> losses, std::span<const uint32_t> pixel_counts,
                    PortableRandom& random) {
  SwarmStep step;
  const std::vector<double> fitness = takeBest(settings, swarm, losses, pixel_counts, step);
  finishIteration(patient(settings), swarm.state, step);

  float least = 1;
  for (std::size_t i = 0; i < fitness.size(); ++i)
    if (fitness[i] >= 0) least = std::min(least, losses[i]);
  std::vector<double> weight_up_to;
  double total = 0;
  for (std::size_t i = 0; i < fitness.size(); ++i) {
    const bool counts =
        fitness[i] >= 0 && (i > 0 || step.advantage == 0);  // else the first has been replaced
    weight_up_to.push_back(total += counts ? std::exp((least - losses[i]) / pfo.temperature) : 0);
  }
  if (!(total > 0)) return step;  // no particle counts: the same ones meet the next pixels

  // Systematic resampling: evenly spaced places on the summed weights, so that chance adds as little as can
  // be.
  Vector6 deviation;
  deviation << Eigen::Vector3d::Constant(pfo.shift_deviation), Eigen::Vector3d::Constant(pfo.turn_deviation);
  const auto count = static_cast<std::size_t>(settings.levels[swarm.state.level].particles);
  const double spacing = total / static_cast<double>(count - 1);
  std::vector<Vector6> next = {swarm.particles[0]};
  double place = spacing * random.uniform();
  for (std::size_t i = 0; next.size() < count; place += spacing) {
    while (i + 1 < weight_up_to.size() && weight_up_to[i] <= place) ++i;
    Vector6 moved = swarm.particles[i];
    for (int axis = 0; axis < 6; ++axis) moved[axis] += deviation[axis] * normal(random);
    next.push_back(moved);
  }
  swarm.particles = std::move(next);
  return step;
}

SwarmStep updatePso(const SwarmSettings& settings, const PsoSettings& pso, FreeSwarm& swarm,
                    std::span<const float> losses, std::span<const uint32_t> pixel_counts,
                    PortableRandom& random) {
  SwarmStep step;
  const std::vector<double> fitness = takeBest(settings, swarm, losses, pixel_counts, step);
  for (std::size_t i = 1; i < fitness.size(); ++i) {
    if (fitness[i] > swarm.own_best_fitness[i]) {
      swarm.own_best_fitness[i] = fitness[i];
      swarm.own_best[i] = swarm.particles[i];
    }
    for (int axis = 0; axis < 6; ++axis) {
      const double at = swarm.particles[i][axis];
      swarm.velocities[i][axis] = pso.inertia * swarm.velocities[i][axis] +
                                  pso.own_pull * random.uniform() * (swarm.own_best[i][axis] - at) +
                                  pso.swarm_pull * random.uniform() * (swarm.particles[0][axis] - at);
    }
    swarm.particles[i] += swarm.velocities[i];
  }
  finishIteration(patient(settings), swarm.state, step);
  return step;
}

}  // namespace rosefusion
