// A buffer with its memory, for shaders to read and write.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/device.h"

struct VkBuffer_T;  // what Vulkan's handle points to

namespace rosefusion {

enum class Memory {
  Device,    ///< fast for shaders; not mapped
  Upload,    ///< mapped and coherent; the host writes, shaders read
  Readback,  ///< mapped, cached where possible; shaders write, the host only reads
};

/// A handle: copies name the same storage, which goes with the last of them and must not outlive its Device.
/// Contents are undefined at first.
class Buffer {
 public:
  Buffer();
  /// `bytes` is rounded up to a multiple of 4, at least 16. Throws DeviceError (OutOfMemory).
  Buffer(Device& device, std::uint64_t bytes, Memory memory);
  ~Buffer();
  Buffer(const Buffer&);
  Buffer& operator=(const Buffer&);
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  std::uint64_t bytes() const;
  explicit operator bool() const { return impl_ != nullptr; }

  /// The mapped contents as an array of T; of Memory::Readback as they are now, so that it is asked for again
  /// after each submit. Throws DeviceError (Programming) for Memory::Device.
  template <typename T>
  std::span<T> as() const {
    return {static_cast<T*>(mapped()), bytes() / sizeof(T)};
  }

  /// Null when empty. Usage: storage, uniform, uniform texels, transfer source and destination; one queue
  /// family.
  VkBuffer_T* handle() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  void* mapped() const;
  std::shared_ptr<Impl> impl_;
};

/// Some of a buffer's bytes; a buffer stands for all of its own.
struct BufferPart {
  BufferPart(const Buffer& whole) : buffer(whole), bytes(whole.bytes()) {}
  BufferPart(const Buffer& of, std::uint64_t from, std::uint64_t size)
      : buffer(of), offset(from), bytes(size) {}
  Buffer buffer;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

}  // namespace rosefusion
