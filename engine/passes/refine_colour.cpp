#include "engine/passes/refine_colour.h"

#include <algorithm>
#include <cstring>

#include "engine/error.h"
#include "engine/passes/part_sums.h"

namespace rosefusion {

using namespace shader;

RefineColourPass::RefineColourPass(Device& device)
    : device_(device),
      kernels_(device, readerCode(device, "refine_colour"), kRefineColourBindings,
               sizeof(RefineColourParams)) {}

void RefineColourPass::record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
                              const SelectPointsPass& points, const CameraIntrinsics& camera,
                              std::span<const RefineColourCandidate> candidates, float huber) {
  const Recorder::Whole whole(recorder);
  if (!frame.has_colour || !volume.options().colour)
    throw DeviceError(DeviceErrorCode::Programming, "Colours are compared where frame and volume have none.");
  // Parts for all of a CPU's cores, or enough to fill a GPU with a few candidates.
  const std::uint32_t wanted = device_.info().type == DeviceType::Cpu ? 16 : 128;
  count_ = static_cast<std::uint32_t>(candidates.size());
  parts_ = std::max(wanted, points.cells() / (kRefineColourGroup * (kLongestLoop / 128)) + 1);
  if (candidates_.bytes() < candidates.size_bytes())
    candidates_ = Buffer(device_, candidates.size_bytes(), Memory::Upload);
  std::memcpy(candidates_.as<char>().data(), candidates.data(), candidates.size_bytes());
  const std::uint64_t bytes = sizeof(float) * kRefineColourSums * count_ * parts_;
  if (sums_.bytes() < bytes) sums_ = Buffer(device_, bytes, Memory::Readback);

  const RefineColourParams params{camera.focal_centre, camera.size, huber, parts_, 0, 0};
  recorder.dispatch(kernels_.of(volume.chunks(), addsManyTerms(points.cells(), parts_ * kRefineColourGroup)),
                    {volume.layoutBuffer(), volume.table(), volume.colour(), points.points(), points.count(),
                     frame.colour, candidates_, sums_},
                    params, Threads{parts_ * kRefineColourGroup, count_});
}

std::vector<RefineColourSums> RefineColourPass::sums() const {
  return addParts<RefineColourSums>(sums_.as<float>(), count_, parts_);
}

}  // namespace rosefusion
