// What the host writes and shaders read many times.
#pragma once
#include <cstring>

#include "engine/recorder.h"

namespace rosefusion {

/// One buffer where the device shares the host's memory, else one of each, and a copy between them. A handle,
/// as Buffer is.
class Uploaded {
 public:
  Uploaded() = default;
  Uploaded(Device& device, std::uint64_t bytes)
      : host_(device, bytes, Memory::Upload),
        device_(device.info().hasOwnMemory() ? Buffer(device, bytes, Memory::Device) : host_) {}

  std::uint64_t bytes() const { return host_.bytes(); }
  /// For the host to fill while nothing that reads it is running; record() then makes shaders see it.
  template <typename T>
  std::span<T> as() const {
    return host_.as<T>();
  }
  void record(Recorder& recorder) const {
    if (host_.handle() != device_.handle()) recorder.copy(host_, device_, host_.bytes());
  }
  const Buffer& buffer() const { return device_; }

 private:
  Buffer host_, device_;
};

}  // namespace rosefusion
