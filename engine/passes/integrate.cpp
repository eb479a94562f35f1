#include "engine/passes/integrate.h"

#include <cstring>
#include <span>

namespace rosefusion {

using namespace shader;

IntegratePass::IntegratePass(Device& device)
    : device_(device),
      kernels_(device, readerCode(device, "integrate"),
               device.info().readsTexels() ? kIntegrateTexelBindings : kIntegrateBindings,
               sizeof(IntegrateParams)) {}

void IntegratePass::record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
                           const CameraIntrinsics& camera, const glm::mat4& camera_from_world, float far,
                           const SensorNoise& noise) {
  const Recorder::Whole whole(recorder);
  volume.visibleBlocks(camera_from_world, camera.focal_centre, camera.size, far, frame.reach(), slots_);
  if (slots_.empty()) return;
  const std::uint64_t bytes = 4 * slots_.size();
  if (visible_.bytes() < bytes) visible_ = Buffer(device_, bytes * 3 / 2, Memory::Upload);
  std::memcpy(visible_.as<char>().data(), slots_.data(), bytes);

  const bool colour = volume.options().colour && frame.has_colour;
  const IntegrateParams params{camera_from_world,
                               camera.focal_centre,
                               glm::ivec4(camera.size.x, camera.size.y, static_cast<int>(slots_.size()), 0),
                               noise.floor,
                               noise.growth,
                               noise.bias_growth,
                               volume.options().thin_walls};
  std::vector<BoundBuffers> buffers{volume.layoutBuffer(), volume.blockBuffer(), visible_,
                                    frame.depth,           frame.colour,         volume.tsdf(),
                                    volume.weight(),       volume.colour()};
  if (device_.info().readsTexels())
    buffers.insert(buffers.end(), {volume.tsdf(), volume.weight(), volume.colour()});
  recorder.dispatchBytes(kernels_.of(volume.chunks(), colour), buffers, &params, sizeof(params),
                         Groups{static_cast<std::uint32_t>(slots_.size())});
}

}  // namespace rosefusion
