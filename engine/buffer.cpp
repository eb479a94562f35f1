#include "engine/buffer.h"

#include <algorithm>

#include "engine/buffer_impl.h"
#include "engine/error.h"
#include "engine/memory_types.h"

namespace rosefusion {
namespace {

/// Vulkan leaves larger requests undefined, so they are refused before it sees them.
void requireAtMost(std::uint64_t most, std::uint64_t bytes, const DeviceInfo& device) {
  if (bytes <= most) return;
  throw DeviceError(DeviceErrorCode::OutOfMemory,
                    "A buffer of " + std::to_string(bytes >> 20) + " MiB is more than " + device.name +
                        " allocates at once (" + std::to_string(most >> 20) +
                        " MiB); make volume.voxel_size larger or depth.max smaller.");
}

/// Where a heap is too small or full, from the next.
VkMemoryType allocate(Buffer::Impl& buffer, const VkMemoryRequirements& requirements, Memory use,
                      const Device::Impl& device, const std::string& doing) {
  const auto types = memoryTypesFor(use, requirements.size, device.memory, requirements.memoryTypeBits);
  if (types.empty())
    throw DeviceError(DeviceErrorCode::MissingLimit, device.info.name + " has no memory type for buffers.");
  const auto heapBytes = [&](std::uint32_t type) -> std::uint64_t {
    return device.memory.memoryHeaps[device.memory.memoryTypes[type].heapIndex].size;
  };
  requireAtMost(heapBytes(*std::ranges::max_element(types, {}, heapBytes)), requirements.size, device.info);
  VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  for (const std::uint32_t type : types) {
    if (heapBytes(type) < requirements.size) continue;
    result = buffer.memory.make(device, VkMemoryAllocateInfo{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                             .allocationSize = requirements.size,
                                                             .memoryTypeIndex = type});
    if (result == VK_SUCCESS) return device.memory.memoryTypes[type];
  }
  require(result, doing);
  return {};
}

}  // namespace

Buffer::Buffer(Device& owner, std::uint64_t bytes, Memory memory) : impl_(new Impl) {
  Device::Impl& device = owner.impl();
  requireAtMost(device.info.limits.max_allocation_bytes, bytes, device.info);
  bytes = std::max<std::uint64_t>(16, (bytes + 3) / 4 * 4);
  const std::string doing = "allocating " + (bytes >> 20 ? std::to_string(bytes >> 20) + " MiB"
                                                         : std::to_string((bytes + 1023) >> 10) + " KiB");
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
  const VkMemoryType type = allocate(*impl_, requirements, memory, device, doing);
  require(device.vk.BindBufferMemory(device.device, impl_->buffer, impl_->memory, 0), doing);
  impl_->invalidate = !(type.propertyFlags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
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
  if (impl_->invalidate) {
    const VkMappedMemoryRange whole{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, impl_->memory, 0,
                                    VK_WHOLE_SIZE};
    require(impl_->device->vk.InvalidateMappedMemoryRanges(impl_->device->device, 1, &whole),
            "reading a buffer");
  }
  return impl_->mapped;
}

}  // namespace rosefusion
