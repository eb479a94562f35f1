// Swarms whose particles move one by one, for comparison with the template: particle filter optimisation
// (pfo) and particle swarm optimisation (pso). Pure, in double precision; whoever evaluates the losses is not
// known here.
#pragma once
#include <span>
#include <vector>

#include "host/swarm/random.h"
#include "host/swarm/swarm_update.h"

namespace rosefusion {

/// One frame's swarm. Levels and the reach of the first iteration are the template search's; the search
/// always takes max_iterations.
struct FreeSwarm {
  SwarmState state;                ///< state.centre: best pose so far, world_from_camera
  Pose start = Pose::Identity();   ///< what the particles are moves of
  std::vector<Vector6> particles;  ///< the first is the best so far and never moves by itself
  // Of pso only, by particle.
  std::vector<Vector6> velocities;
  std::vector<Vector6> own_best;
  std::vector<double> own_best_fitness;  ///< below 0: not counted yet

  /// How many of the particles, from the first on, the next iteration evaluates: the level's number.
  std::size_t evaluated(const SwarmSettings& settings) const;
};

/// The particles are those of `first`, scaled as the template search's first iteration scales it.
FreeSwarm beginFreeSwarm(const SwarmSettings& settings, const Pose& start, const SwarmTemplate& first,
                         const SwarmState* previous_frame);

/// One iteration: the particles are resampled by their weights, as many as the next level has, and each is
/// moved by the proposal. Losses and counts as in update() of swarm_update.h, of the evaluated particles;
/// std::invalid_argument as there.
SwarmStep updatePfo(const SwarmSettings& settings, const PfoSettings& pfo, FreeSwarm& swarm,
                    std::span<const float> losses, std::span<const uint32_t> pixel_counts,
                    PortableRandom& random);

/// One iteration: every evaluated particle is pulled towards its own best place and the swarm's. The others
/// wait for a level that has them. The rest as updatePfo.
SwarmStep updatePso(const SwarmSettings& settings, const PsoSettings& pso, FreeSwarm& swarm,
                    std::span<const float> losses, std::span<const uint32_t> pixel_counts,
                    PortableRandom& random);

}  // namespace rosefusion
