#include "host/slam/tracking/particle_evaluator.h"

#include "host/slam/shader_types.h"

namespace rosefusion {

ParticleEvaluator::ParticleEvaluator(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                                     std::span<const glm::vec4> templates)
    : recorder(device),
      select(device, toShader(intrinsics)),
      fitness(device, templates, settings.swarm.loss == FitnessLoss::Squared ? Loss::Squared : Loss::Absolute,
              settings.tracking.compensate),
      settings_(settings.tracking),
      camera_(toShader(intrinsics)) {}

void ParticleEvaluator::evaluate(const DeviceFrame& frame, const Volume& volume, const PixelGrid& grid,
                                 const Pose& centre, const Pose& last, const SwarmPlacement& swarm) {
  const glm::mat4 previous_from_current = toShader(last.inverse() * centre);
  select.record(recorder, frame, grid,
                settings_.overlap == Overlap::BestPose ? &previous_from_current : nullptr);
  const LastView view{toShader(last.inverse()), camera_};
  fitness.record(recorder, volume, select, swarm,
                 settings_.overlap == Overlap::EachParticle ? &view : nullptr);
  recorder.submit();
  if (settings_.normalise) return;
  sums_.assign(fitness.losses().begin(), fitness.losses().end());
  const auto looked_at = static_cast<float>(select.valid());
  for (std::size_t i = 0; i < sums_.size(); ++i)
    if (sums_[i] >= 0) sums_[i] *= static_cast<float>(fitness.counted()[i]) / looked_at;
}

std::span<const float> ParticleEvaluator::losses() const {
  return settings_.normalise ? fitness.losses() : std::span<const float>(sums_);
}

}  // namespace rosefusion
