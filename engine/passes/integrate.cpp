#include "engine/passes/integrate.h"

#include <cstring>
#include <span>

namespace rosefusion {

using namespace shader;

IntegratePass::IntegratePass(Device& device) : device_(device) {}

void IntegratePass::record(Recorder& recorder, const Volume& volume, const PreprocessPass& frame,
                           const CameraIntrinsics& camera, const glm::mat4& camera_from_world, float far,
                           const SensorNoise& noise) {
  const Recorder::Whole whole(recorder);
  volume.visibleBlocks(camera_from_world, camera.focal_centre, camera.size, far, frame.reach(), slots_);
  if (slots_.empty()) return;
  const std::uint64_t bytes = 4 * slots_.size();
  if (visible_.bytes() < bytes) visible_ = Buffer(device_, bytes * 3 / 2, Memory::Upload);
  std::memcpy(visible_.as<char>().data(), slots_.data(), bytes);

  const std::uint32_t bindings = device_.info().readsTexels() ? kIntegrateTexelBindings : kIntegrateBindings;
  Kernel& kernel = kernels_[volume.chunks()];
  if (!kernel)
    kernel = Kernel(device_, readerCode(device_, "integrate"), bindings, sizeof(IntegrateParams),
                    {volume.chunks()});
  const bool colour = volume.options().colour && frame.hasColour();
  const IntegrateParams params{
      camera_from_world,
      camera.focal_centre,
      glm::ivec4(camera.size.x, camera.size.y, static_cast<int>(slots_.size()), colour),
      noise.floor,
      noise.growth,
      noise.bias_growth,
      volume.options().thin_walls};
  const Buffer* buffers[kIntegrateTexelBindings] = {&volume.layoutBuffer(), &volume.blockBuffer(), &visible_,
                                                    &frame.depth(), &frame.colour()};
  for (std::uint32_t chunk = 0; chunk < kMaxPoolChunks; ++chunk) {
    buffers[kIntegrateBindTsdf + chunk] = buffers[kIntegrateBindTsdfTexels + chunk] = &volume.tsdf(chunk);
    buffers[kIntegrateBindWeight + chunk] = buffers[kIntegrateBindWeightTexels + chunk] =
        &volume.weight(chunk);
    buffers[kIntegrateBindColour + chunk] = buffers[kIntegrateBindColourTexels + chunk] =
        &volume.colour(chunk);
  }
  recorder.dispatchGroups(kernel, std::span(buffers).first(bindings), &params, sizeof(params),
                          static_cast<std::uint32_t>(slots_.size()));
}

}  // namespace rosefusion
