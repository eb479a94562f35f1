#include "engine/passes/refine.h"

#include <algorithm>
#include <cstring>
#include <numbers>

#include "engine/passes/part_sums.h"

namespace rosefusion {

using namespace shader;

RefinePass::RefinePass(Device& device)
    : device_(device),
      kernels_(device, readerCode(device, "refine"), kRefineBindings, sizeof(RefineParams)) {}

void RefinePass::record(Recorder& recorder, const Volume& volume, const SelectPointsPass& points,
                        std::span<const RefineCandidate> candidates, const CameraIntrinsics& last_camera,
                        const RefineWeights& weights) {
  const Recorder::Whole whole(recorder);
  // Parts for all of a CPU's cores, or enough to fill a GPU with a few candidates.
  const std::uint32_t wanted = device_.info().type == DeviceType::Cpu ? 16 : 128;
  count_ = static_cast<std::uint32_t>(candidates.size());
  parts_ = std::max(wanted, points.cells() / (kRefineGroup * (kLongestLoop / 32)) + 1);
  if (candidates_.bytes() < candidates.size_bytes())
    candidates_ = Buffer(device_, candidates.size_bytes(), Memory::Upload);
  std::memcpy(candidates_.as<char>().data(), candidates.data(), candidates.size_bytes());
  const std::uint64_t bytes = sizeof(float) * kRefineSums * count_ * parts_;
  if (sums_.bytes() < bytes) sums_ = Buffer(device_, bytes, Memory::Readback);

  // The eight voxels around a point are up to a cell's diagonal away from it.
  const float inside = std::max(last_camera.focal_centre.x, last_camera.focal_centre.y) *
                       std::numbers::sqrt3_v<float> * volume.options().voxel_size;
  const RefineParams params{weights.huber,
                            weights.noise.floor,
                            weights.noise.growth,
                            parts_,
                            glm::vec4(last_camera.size.x, last_camera.size.y, inside, 0),
                            weights.noise.bias_growth,
                            weights.model_noise,
                            weights.front_only};
  recorder.dispatch(kernels_.of(volume.chunks(), addsManyTerms(points.cells(), parts_ * kRefineGroup)),
                    {volume.layoutBuffer(), volume.table(), volume.tsdf(), points.points(), points.count(),
                     candidates_, sums_, volume.weight()},
                    params, Threads{parts_ * kRefineGroup, count_});
}

std::vector<RefineSums> RefinePass::bands(std::size_t candidate, std::size_t most) const {
  std::vector<RefineSums> out(std::min<std::size_t>(most, parts_), RefineSums{});
  const auto values = sums_.as<float>().subspan(candidate * parts_ * kRefineSums);
  for (std::size_t part = 0; part < parts_; ++part)
    for (std::size_t k = 0; k < kRefineSums; ++k)
      out[part * out.size() / parts_][k] += values[part * kRefineSums + k];
  return out;
}

std::vector<RefineSums> RefinePass::sums() const {
  return addParts<RefineSums>(sums_.as<float>(), count_, parts_);
}

}  // namespace rosefusion
