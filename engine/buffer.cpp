#include "engine/buffer.h"

#include <algorithm>

#include "engine/buffer_impl.h"
#include "engine/error.h"

namespace rosefusion {
namespace {

using Property = vk::MemoryPropertyFlagBits;

constexpr std::uint64_t kSmallUpload = 1 << 16;  // bytes

/// First memory type that has all of `wanted`, else of `needed`; -1 when there is none.
int memoryType(const vk::PhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
               vk::MemoryPropertyFlags needed, vk::MemoryPropertyFlags wanted) {
  for (const auto flags : {needed | wanted, needed})
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((allowed >> i & 1u) && (memory.memoryTypes[i].propertyFlags & flags) == flags)
        return static_cast<int>(i);
  return -1;
}

/// Vulkan leaves larger requests undefined, so they are refused before it sees them.
void requireAtMost(std::uint64_t most, std::uint64_t bytes, const DeviceInfo& device) {
  if (bytes <= most) return;
  throw DeviceError(DeviceErrorCode::OutOfMemory,
                    "A buffer of " + std::to_string(bytes >> 20) + " MiB is more than " + device.name +
                        " allocates at once (" + std::to_string(most >> 20) +
                        " MiB); make volume.voxel_size larger or depth.max smaller.");
}

}  // namespace

Buffer::Buffer(Device& owner, std::uint64_t bytes, Memory memory) : impl_(new Impl) {
  Device::Impl& device = owner.impl();
  requireAtMost(device.info.limits.max_allocation_bytes, bytes, device.info);
  bytes = std::max<std::uint64_t>(16, (bytes + 3) / 4 * 4);
  try {
    using Usage = vk::BufferUsageFlagBits;
    impl_->buffer = {
        device.device,
        vk::BufferCreateInfo({}, bytes,
                             Usage::eStorageBuffer | Usage::eUniformBuffer | Usage::eUniformTexelBuffer |
                                 Usage::eTransferSrc | Usage::eTransferDst),
        device.allocator};
    const auto requirements = impl_->buffer.getMemoryRequirements();
    const vk::MemoryPropertyFlags host = Property::eHostVisible | Property::eHostCoherent;
    // Parameters that every invocation reads belong beside the processors; images cross once anyway.
    const bool beside = memory == Memory::Upload && bytes <= kSmallUpload;
    const auto allocate = [&](vk::MemoryPropertyFlags needed, vk::MemoryPropertyFlags wanted) {
      const int type = memoryType(device.memory, requirements.memoryTypeBits, needed, wanted);
      if (type < 0)
        throw DeviceError(DeviceErrorCode::MissingLimit,
                          device.info.name + " has no memory type for buffers.");
      requireAtMost(device.memory.memoryHeaps[device.memory.memoryTypes[type].heapIndex].size,
                    requirements.size, device.info);
      impl_->memory = {device.device,
                       vk::MemoryAllocateInfo(requirements.size, static_cast<std::uint32_t>(type)),
                       device.allocator};
    };
    if (memory == Memory::Device) {
      allocate({}, Property::eDeviceLocal);
    } else if (!beside) {
      allocate(host, memory == Memory::Readback ? Property::eHostCached : vk::MemoryPropertyFlags());
    } else {
      try {
        allocate(host, Property::eDeviceLocal);
      } catch (const vk::OutOfDeviceMemoryError&) {
        allocate(host, {});  // the part of the device's memory that the host sees is small on some
      }
    }
    impl_->buffer.bindMemory(*impl_->memory, 0);
    if (memory != Memory::Device) impl_->mapped = impl_->memory.mapMemory(0, bytes);
    // Made with the buffer, not when first bound: copies of it are bound on several threads.
    const auto view = [&](vk::Format format, std::uint64_t texel_bytes) -> vk::raii::BufferView {
      const std::uint64_t range = bytes / texel_bytes * texel_bytes;
      if (bytes / texel_bytes > device.info.limits.max_texels) return nullptr;
      return {device.device, vk::BufferViewCreateInfo({}, *impl_->buffer, format, 0, range),
              device.allocator};
    };
    impl_->words = view(vk::Format::eR32Uint, 4);
    impl_->vectors = view(vk::Format::eR32G32B32A32Sfloat, 16);
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "allocating " + std::to_string(bytes >> 20) + " MiB");
  }
  impl_->bytes = bytes;
  impl_->device = &device;
  device.allocated_bytes += bytes;
}

Buffer::Buffer() = default;
Buffer::~Buffer() = default;
Buffer::Buffer(const Buffer&) = default;
Buffer& Buffer::operator=(const Buffer&) = default;
Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&&) noexcept = default;

std::uint64_t Buffer::bytes() const {
  return impl_ ? impl_->bytes : 0;
}

VkBuffer_T* Buffer::handle() const {
  return impl_ ? static_cast<VkBuffer>(*impl_->buffer) : nullptr;
}

void* Buffer::mapped() const {
  if (!impl_ || !impl_->mapped) throw DeviceError(DeviceErrorCode::Programming, "This buffer is not mapped.");
  return impl_->mapped;
}

}  // namespace rosefusion
