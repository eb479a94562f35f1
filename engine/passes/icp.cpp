#include "engine/passes/icp.h"

#include "engine/passes/part_sums.h"

namespace rosefusion {

using namespace shader;

IcpPass::IcpPass(Device& device, const CameraIntrinsics& camera)
    : camera_(camera),
      kernel_(device, readerCode(device, "icp"), kIcpBindings, sizeof(IcpParams)),
      // For all of a CPU's cores, or to fill a GPU; an invocation then looks at few pixels.
      parts_(device.info().type == DeviceType::Cpu ? 16 : 512),
      model_(device, sizeof(IcpModel), Memory::Upload),
      sums_(device, sizeof(float) * kIcpSums * parts_, Memory::Readback) {}

void IcpPass::record(Recorder& recorder, const DeviceFrame& frame, const RaycastPass& model,
                     const glm::mat4& camera_from_world, const IcpPairing& pairing,
                     const glm::mat4& world_from_camera) {
  const Recorder::Whole whole(recorder);
  const int offset = pairing.stride / 2;
  const glm::ivec4 grid(pairing.stride, offset,
                        (camera_.size.x - offset + pairing.stride - 1) / pairing.stride,
                        (camera_.size.y - offset + pairing.stride - 1) / pairing.stride);
  cells_ = static_cast<std::uint32_t>(grid.z * grid.w);
  model_.as<IcpModel>()[0] = {
      camera_from_world, camera_.focal_centre, camera_.size, grid, pairing.distance, pairing.cosine, 0, 0};
  recorder.dispatch(kernel_, {frame.points, model.surface(), model_, sums_},
                    IcpParams{world_from_camera, parts_, 0, 0, 0}, Threads{parts_ * kIcpGroup});
}

IcpSums IcpPass::sums() const {
  return addParts<IcpSums>(sums_.as<float>(), 1, parts_).front();
}

}  // namespace rosefusion
