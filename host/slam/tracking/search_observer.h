// What a random search looked at, for those who plot it.
#pragma once
#include <functional>
#include <span>

#include "host/swarm/swarm_update.h"

namespace rosefusion {

/// One iteration, before its update.
struct SearchIteration {
  const SwarmState& state;
  std::span<const float> losses;  ///< by particle, the first being the best so far; see swarm_update.h
  const std::function<Pose(std::size_t)>& pose;  ///< world_from_camera of a particle
};

/// Called before each iteration's update; what it is given is valid only during the call.
using SearchObserver = std::function<void(const SearchIteration&)>;

}  // namespace rosefusion
