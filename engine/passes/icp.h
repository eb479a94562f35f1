// Pass icp: the normal equations that move a frame onto the surface that a camera sees in the model.
#pragma once
#include <array>

#include "engine/device_frame.h"
#include "engine/passes/raycast.h"
#include "shaders/compute/interface/icp.h"

namespace rosefusion {

/// Which pixels are paired, and how alike a pair must be.
struct IcpPairing {
  int stride = 1;         ///< every stride-th pixel of every stride-th row
  float distance = 0.1f;  ///< metres, between its points, at most
  float cosine = 0.94f;   ///< between its normals, at least
};

/// Sums over the pairs, indexed by the kIcp... constants of shaders/compute/interface/icp.h.
using IcpSums = std::array<double, shader::kIcpSums>;

/// One camera for life.
class IcpPass {
 public:
  IcpPass(Device& device, const shader::CameraIntrinsics& camera);

  /// The frame at `world_from_camera` against the model as `model` has cast it from `camera_from_world`.
  void record(Recorder& recorder, const DeviceFrame& frame, const RaycastPass& model,
              const glm::mat4& camera_from_world, const IcpPairing& pairing,
              const glm::mat4& world_from_camera);
  /// After the submit.
  IcpSums sums() const;
  /// Pixels of the recorded grid.
  std::uint32_t cells() const { return cells_; }

 private:
  shader::CameraIntrinsics camera_;
  Kernel kernel_;
  std::uint32_t parts_, cells_ = 0;
  Buffer model_, sums_;
};

}  // namespace rosefusion
