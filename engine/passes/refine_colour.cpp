#include "engine/passes/refine_colour.h"

#include <algorithm>
#include <cstring>

#include "engine/error.h"
#include "engine/passes/part_sums.h"

namespace rosefusion {

using namespace shader;

void RefineColourPass::record(Recorder& recorder, const Volume& volume, const PreprocessPass& frame,
                              const SelectPointsPass& points, const CameraIntrinsics& camera,
                              std::span<const RefineColourCandidate> candidates, float huber) {
  const Recorder::Whole whole(recorder);
  if (!frame.hasColour() || !volume.options().colour)
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

  Kernel& kernel = kernels_[volume.chunks()];
  if (!kernel)
    kernel = Kernel(device_, readerCode(device_, "refine_colour"), kRefineColourBindings,
                    sizeof(RefineColourParams), {volume.chunks()});
  const RefineColourParams params{camera.focal_centre, camera.size, huber, parts_, 0, 0};
  const Buffer* buffers[kRefineColourBindings] = {&volume.layoutBuffer(), &volume.table()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk)
    buffers[kRefineColourBindColour + chunk] = &volume.colour(chunk);
  buffers[kRefineColourBindPoints] = &points.points();
  buffers[kRefineColourBindCount] = &points.count();
  buffers[kRefineColourBindImage] = &frame.colour();
  buffers[kRefineColourBindCandidates] = &candidates_;
  buffers[kRefineColourBindSums] = &sums_;
  recorder.dispatchBytes(kernel, buffers, &params, sizeof(params), {parts_ * kRefineColourGroup, count_});
}

std::vector<RefineColourSums> RefineColourPass::sums() const {
  return addParts<RefineColourSums>(sums_.as<float>(), count_, parts_);
}

}  // namespace rosefusion
