#include "host/slam/baselines/free_swarm_search.h"

#include <algorithm>

#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

std::size_t firstLevel(const Settings& settings) {
  if (settings.tracking.method == TrackingMethod::Pfo) return 0;
  const auto& levels = settings.swarm.levels;
  const auto fewer = [](const SwarmLevel& a, const SwarmLevel& b) { return a.particles < b.particles; };
  return static_cast<std::size_t>(std::max_element(levels.begin(), levels.end(), fewer) - levels.begin());
}

std::vector<glm::vec4> onDevice(std::span<const Vector6> particles) {
  std::vector<glm::vec4> out;
  for (const Vector6& p : particles) {
    out.emplace_back(p[0], p[1], p[2], 0);
    out.emplace_back(p[3], p[4], p[5], 0);
  }
  return out;
}

}  // namespace

FreeSwarmSearch::FreeSwarmSearch(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                                 const TemplateSet& templates)
    : settings_(settings),
      templates_(templates),
      first_level_(firstLevel(settings)),
      evaluator_(device, settings, intrinsics, onDevice(std::vector<Vector6>(1, Vector6::Zero()))),
      random_(settings.tracking.seed) {}

TrackResult FreeSwarmSearch::search(const DeviceFrame& frame, const Volume& volume, const Pose& start,
                                    const Pose& last, const SearchObserver& observer) {
  const SwarmSettings& s = settings_.swarm;
  const SwarmState* previous = previous_ ? &*previous_ : nullptr;
  const SwarmTemplate& first = templates_.at(first_level_, previous ? previous->serial : 0);
  FreeSwarm swarm = beginFreeSwarm(s, start, first, previous);
  TrackResult result;
  while (!swarm.state.stopped()) {
    const std::span<const Vector6> particles(swarm.particles.data(), swarm.evaluated(s));
    evaluator_.fitness.setTemplates(onDevice(particles));
    const Eigen::Vector2i offset = pixelOffset(s, swarm.state);
    evaluator_.evaluate(
        frame, volume, {s.levels[swarm.state.level].pixel_stride, offset.x(), offset.y()}, swarm.state.centre,
        last, {toShader(start), glm::vec4(1), glm::vec4(1), 0, static_cast<std::uint32_t>(particles.size())});
    result.lookups += particles.size() * std::uint64_t(evaluator_.select.selected());
    const std::function<Pose(std::size_t)> pose = [&](std::size_t i) { return moveBy(start, particles[i]); };
    if (observer) observer({swarm.state, evaluator_.losses(), pose});
    if (settings_.tracking.method == TrackingMethod::Pfo)
      updatePfo(s, settings_.pfo, swarm, evaluator_.losses(), evaluator_.counted(), random_);
    else
      updatePso(s, settings_.pso, swarm, evaluator_.losses(), evaluator_.counted(), random_);
  }
  result.world_from_camera = swarm.state.centre;
  result.iterations = swarm.state.iteration;
  previous_ = swarm.state;
  return result;
}

}  // namespace rosefusion
