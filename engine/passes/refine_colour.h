// Pass refine_colour: the normal equations that bring the frame's luminance and the model's together.
#pragma once
#include <array>
#include <span>

#include "engine/kernel_variants.h"
#include "engine/passes/select_points.h"
#include "engine/volume.h"
#include "shaders/compute/interface/refine_colour.h"

namespace rosefusion {

/// Sums over the points at one pose, indexed by the kRefineColour... constants of
/// shaders/compute/interface/refine_colour.h.
using RefineColourSums = std::array<double, shader::kRefineColourSums>;

class RefineColourPass {
 public:
  explicit RefineColourPass(Device& device);

  /// At each candidate. `points` are pixels of `frame`, which must have a colour, as must the volume.
  /// Residuals beyond `huber` (of white) count linearly.
  void record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
              const SelectPointsPass& points, const shader::CameraIntrinsics& camera,
              std::span<const shader::RefineColourCandidate> candidates, float huber);
  /// After the submit: one entry per pose, in their order.
  std::vector<RefineColourSums> sums() const;

 private:
  Device& device_;
  KernelVariants kernels_;  ///< by number of pool chunks, and whether lanes compensate
  Buffer candidates_, sums_;
  std::uint32_t count_ = 0, parts_ = 0;
};

}  // namespace rosefusion
