// The Buffer's insides; included by engine/*.cpp only.
#pragma once
#include "engine/buffer.h"
#include "engine/vulkan.h"

namespace rosefusion {

struct Buffer::Impl {
  Device::Impl* device = nullptr;
  std::uint64_t bytes = 0;
  OwnedMemory memory;  // before the buffer, which is destroyed first
  OwnedBuffer buffer;
  void* mapped = nullptr;
  bool invalidate = false;  // before the host reads: the memory is not coherent
  // Its texels, read only; null where they are more than a texel buffer holds.
  OwnedBufferView words;
  OwnedBufferView vectors;  // four floats each
  ~Impl() {
    if (device) device->allocated_bytes -= bytes;
  }
};

}  // namespace rosefusion
