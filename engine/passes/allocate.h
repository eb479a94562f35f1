// Pass allocate: gives the volume the blocks that a depth image's surface needs.
#pragma once
#include "engine/device_frame.h"
#include "engine/volume.h"
#include "shaders/compute/interface/allocate.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

class AllocatePass {
 public:
  /// `capacity`: requests that can be listed at first; a fuller frame enlarges it.
  explicit AllocatePass(Device& device, std::uint32_t capacity = 1u << 16);

  /// Marks and lists absent blocks around the surface. Follow it with a submit and then finish().
  void record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
              const shader::CameraIntrinsics& camera, const glm::mat4& world_from_camera);
  /// Hands the listed blocks to the volume, for what `recorder` records next. True when the table or the list
  /// had to grow: record and submit again. Throws DeviceError (OutOfMemory) and leaves the volume usable.
  bool finish(Recorder& recorder, Volume& volume);

 private:
  Device& device_;
  Kernel kernel_;
  std::uint32_t capacity_;
  Buffer empty_;  // the header of a list without requests
  Buffer requests_;
};

}  // namespace rosefusion
