// The searches of pfo and pso: losses from the device, their updates on the host.
#pragma once
#include <optional>

#include "host/slam/baselines/free_swarm.h"
#include "host/slam/tracking/particle_evaluator.h"
#include "host/slam/tracking/search_observer.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

/// Keeps what one frame's swarm hands to the next. One thread.
class FreeSwarmSearch {
 public:
  /// tracking.method chooses between pfo and pso. `templates` (the first swarm of every frame is one of them)
  /// must outlive this.
  FreeSwarmSearch(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                  const TemplateSet& templates);

  /// As SwarmSearch::search.
  TrackResult search(const DeviceFrame& frame, const Volume& volume, const Pose& start, const Pose& last,
                     const SearchObserver& observer = {});

 private:
  const Settings settings_;
  const TemplateSet& templates_;
  std::size_t
      first_level_;  ///< of the templates: where pso starts with all, pfo with its first level's number
  ParticleEvaluator evaluator_;
  PortableRandom random_;
  std::optional<SwarmState> previous_;
};

}  // namespace rosefusion
