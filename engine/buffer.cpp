#include "engine/buffer.h"

#include <algorithm>

#include "engine/buffer_impl.h"
#include "engine/error.h"

namespace rosefusion {
namespace {

constexpr std::uint64_t kSmallUpload = 1 << 16;  // bytes

/// First memory type that has all of `wanted`, else of `needed`; -1 when there is none.
int memoryType(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
               VkMemoryPropertyFlags needed, VkMemoryPropertyFlags wanted) {
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
  const std::string doing = "allocating " + std::to_string(bytes >> 20) + " MiB";
  impl_->buffer = {
      device,
      VkBufferCreateInfo{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                         .size = bytes,
                         .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                  VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                  VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT},
      doing};
  VkMemoryRequirements requirements;
  device.vk.GetBufferMemoryRequirements(device.device, impl_->buffer, &requirements);
  const VkMemoryPropertyFlags host =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  // Parameters that every invocation reads belong beside the processors; images cross once anyway.
  const bool beside = memory == Memory::Upload && bytes <= kSmallUpload;
  const auto allocate = [&](VkMemoryPropertyFlags needed, VkMemoryPropertyFlags wanted) {
    const int type = memoryType(device.memory, requirements.memoryTypeBits, needed, wanted);
    if (type < 0)
      throw DeviceError(DeviceErrorCode::MissingLimit, device.info.name + " has no memory type for buffers.");
    requireAtMost(device.memory.memoryHeaps[device.memory.memoryTypes[type].heapIndex].size,
                  requirements.size, device.info);
    return impl_->memory.make(device,
                              VkMemoryAllocateInfo{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                   .allocationSize = requirements.size,
                                                   .memoryTypeIndex = static_cast<std::uint32_t>(type)});
  };
  if (memory == Memory::Device) {
    require(allocate({}, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), doing);
  } else if (!beside) {
    require(allocate(host, memory == Memory::Readback ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT : 0), doing);
  } else if (allocate(host, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != VK_SUCCESS) {
    require(allocate(host, {}),
            doing);  // the part of the device's memory that the host sees is small on some
  }
  require(device.vk.BindBufferMemory(device.device, impl_->buffer, impl_->memory, 0), doing);
  if (memory != Memory::Device)
    require(device.vk.MapMemory(device.device, impl_->memory, 0, VK_WHOLE_SIZE, 0, &impl_->mapped), doing);
  // Made with the buffer, not when first bound: copies of it are bound on several threads.
  const auto view = [&](VkFormat format, std::uint64_t texel_bytes) -> OwnedBufferView {
    if (bytes / texel_bytes > device.info.limits.max_texels) return {};
    return {device,
            VkBufferViewCreateInfo{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                   .buffer = impl_->buffer,
                                   .format = format,
                                   .range = bytes / texel_bytes * texel_bytes},
            doing};
  };
  impl_->words = view(VK_FORMAT_R32_UINT, 4);
  impl_->vectors = view(VK_FORMAT_R32G32B32A32_SFLOAT, 16);
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
  return impl_ ? static_cast<VkBuffer>(impl_->buffer) : nullptr;
}

void* Buffer::mapped() const {
  if (!impl_ || !impl_->mapped) throw DeviceError(DeviceErrorCode::Programming, "This buffer is not mapped.");
  return impl_->mapped;
}

}  // namespace rosefusion
