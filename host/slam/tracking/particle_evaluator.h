// A swarm's losses on the device, over the pixels and in the way that the settings ask for.
#pragma once
#include <span>
#include <vector>

#include "engine/passes/fitness.h"
#include "host/core/camera.h"
#include "host/settings/settings.h"

namespace rosefusion {

/// One thread.
class ParticleEvaluator {
 public:
  ParticleEvaluator(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                    std::span<const glm::vec4> templates);

  /// `centre`: the best pose so far, `last`: the last frame's, for the overlap [eq. validness].
  void evaluate(const DeviceFrame& frame, const Volume& volume, const PixelGrid& grid, const Pose& centre,
                const Pose& last, const SwarmPlacement& swarm);
  /// Of the last evaluate(), by particle; negative where no pixel was counted.
  std::span<const float> losses() const;
  std::span<const std::uint32_t> counted() const { return fitness.counted(); }

  // The parts, for other ways of looking.
  Recorder recorder;
  SelectPointsPass select;
  FitnessPass fitness;

 private:
  const TrackingSettings settings_;
  shader::CameraIntrinsics camera_;
  std::vector<float> sums_;  ///< of losses that are not normalised
};

}  // namespace rosefusion
