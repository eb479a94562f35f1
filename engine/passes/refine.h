// Pass refine: the normal equations that move a pose onto the model's surface, for several poses at once.
#pragma once
#include <array>
#include <span>

#include "engine/kernel_variants.h"
#include "engine/passes/select_points.h"
#include "engine/sensor_noise.h"
#include "engine/volume.h"
#include "shaders/compute/interface/refine.h"

namespace rosefusion {

/// A residual weighs (floor / deviation)^2 of the depth's noise and the model's together, less beyond `huber`
/// (metres), where it counts linearly. The model's variance falls with the weight that a voxel gathered.
struct RefineWeights {
  float huber = 0.02f;
  SensorNoise noise;
  float model_noise = 0;  ///< of the surface in a voxel of weight 1, metres
  bool front_only =
      false;  ///< leaves out points where the model shows a surface's back: a thin wall's other side
};

/// Sums over the points at one pose, indexed by the kRefine... constants of
/// shaders/compute/interface/refine.h.
using RefineSums = std::array<double, shader::kRefineSums>;

class RefinePass {
 public:
  explicit RefinePass(Device& device);

  /// Makes the kernel now, not inside the first record().
  void prepare(const VolumeView& volume) {
    kernels_.of(volume.chunks(), device_.info().type == DeviceType::Cpu);
  }

  /// At each candidate. Points without a distance (truncated or unobserved voxels beside them) count only in
  /// the costs, and there only where the last image, of `last_camera`, holds them with all voxels beside
  /// them.
  void record(Recorder& recorder, const Volume& volume, const SelectPointsPass& points,
              std::span<const shader::RefineCandidate> candidates,
              const shader::CameraIntrinsics& last_camera, const RefineWeights& weights);
  /// After the submit: one entry per pose, in their order.
  std::vector<RefineSums> sums() const;
  /// The same of one candidate, by so many bands of rows at most: the points are in the image's order.
  std::vector<RefineSums> bands(std::size_t candidate, std::size_t most) const;

 private:
  Device& device_;
  KernelVariants kernels_;  ///< by number of pool chunks, and whether lanes compensate
  Buffer candidates_, sums_;
  std::uint32_t count_ = 0, parts_ = 0;
};

}  // namespace rosefusion
