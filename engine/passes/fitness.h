// Passes fitness and fitness_reduce: the mean loss of every particle of a swarm template.
#pragma once
#include <span>

#include "engine/kernel_variants.h"
#include "engine/passes/select_points.h"
#include "engine/volume.h"
#include "shaders/compute/interface/fitness.h"
#include "shaders/compute/interface/fitness_reduce.h"

namespace rosefusion {

enum class Loss : std::uint32_t { Squared = shader::kLossSquared, Absolute = shader::kLossAbsolute };

/// The swarm of one iteration: `particles` template entries from `first_particle` on, scaled by the axis
/// lengths (x, y, z in metres; qx, qy, qz) and applied to the centre.
struct SwarmPlacement {
  glm::mat4 world_from_camera{1};
  glm::vec4 translation_lengths{0};
  glm::vec4 rotation_lengths{0};
  std::uint32_t first_particle = 0;
  std::uint32_t particles = 0;
  /// Racing: particles whose mean loss over n points exceeds particle 0's by more than this / sqrt(n) are
  /// given up early, where all that share an invocation are, and have no loss; 0: none is. Only points walked
  /// in one slice are raced over.
  float race_margin = 0;
};

/// The last frame's camera, against which each particle tests its own overlap [eq:validness, at the
/// particle's pose].
struct LastView {
  glm::mat4 camera_from_world{1};
  shader::CameraIntrinsics camera;
};

class FitnessPass {
 public:
  /// `templates`: two vec4 per particle, (x, y, z, 0) and (qx, qy, qz, 0), all templates one after the other.
  /// `slices`: into how many parts the points are split, 0 chooses by the device (CPUs 1, GPUs enough to fill
  /// them); more where a part would be longer than a loop may be.
  FitnessPass(Device& device, std::span<const glm::vec4> templates, Loss loss, bool compensate = true,
              std::uint32_t slices = 0);

  /// Replaces the templates, for swarms whose particles move one by one; between submits.
  void setTemplates(std::span<const glm::vec4> templates);

  /// Makes the kernels of such a swarm now, not inside its first record().
  void prepare(const VolumeView& volume, bool overlap_per_particle, bool racing);

  /// With `last_view` a particle counts only the points that it moves into that view; without, it counts all
  /// points.
  void record(Recorder& recorder, const Volume& volume, const SelectPointsPass& points,
              const SwarmPlacement& swarm, const LastView* last_view = nullptr);
  /// After the submit: mean loss per particle in [0, 1], negative when no point was counted.
  std::span<const float> losses() const { return loss_buffer_.as<float>().first(particles_); }
  /// After the submit: points counted per particle.
  std::span<const std::uint32_t> counted() const { return counted_.as<std::uint32_t>().first(particles_); }
  /// After the submit: TSDF lookups of all particles.
  std::uint64_t lookups() const;

 private:
  const Kernel& kernel(const VolumeView& volume, bool overlap_per_particle, bool racing) {
    return kernels_.of(volume.chunks(), loss_, compensate_, overlap_per_particle, racing);
  }

  Device& device_;
  Loss loss_;
  bool compensate_;
  std::uint32_t slices_;
  KernelVariants kernels_;  ///< by number of pool chunks, loss, compensation, overlap per particle, racing
  Kernel reduce_;
  Buffer templates_, partial_, loss_buffer_, counted_, walked_, overlap_;
  std::uint32_t particles_ = 0;
  bool raced_ = false;
};

}  // namespace rosefusion
