#include "engine/memory_types.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr VkMemoryPropertyFlags kDevice = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kVisible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
constexpr VkMemoryPropertyFlags kCoherent = VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

constexpr std::uint64_t kSmallUpload = 1 << 16;  // bytes

/// Types with any other property are for other ends: protected from the host, lazily allocated, slower for
/// the sake of debuggers (AMD's device-coherent), or of a kind that needs a feature switched on.
bool isPlain(VkMemoryPropertyFlags flags) {
  return (flags & ~(kDevice | kVisible | kCoherent | kCached)) == 0;
}

/// Properties to look for, one wish after the other.
std::vector<VkMemoryPropertyFlags> wishes(Memory use, std::uint64_t bytes) {
  switch (use) {
    case Memory::Device:
      return {kDevice, 0};
    case Memory::Readback:  // memory that is not cached is many times slower to read than invalidating is
      return {kVisible | kCoherent | kCached, kVisible | kCached, kVisible | kCoherent};
    default:
      // Parameters that every invocation reads belong beside the processors; images cross once anyway.
      if (bytes <= kSmallUpload) return {kVisible | kCoherent | kDevice, kVisible | kCoherent};
      return {kVisible | kCoherent};
  }
}

}  // namespace

std::vector<std::uint32_t> memoryTypesFor(Memory use, std::uint64_t bytes,
                                          const VkPhysicalDeviceMemoryProperties& memory,
                                          std::uint32_t allowed) {
  std::vector<std::uint32_t> types;
  for (const VkMemoryPropertyFlags wish : wishes(use, bytes))
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      const VkMemoryPropertyFlags flags = memory.memoryTypes[i].propertyFlags;
      if ((allowed >> i & 1u) && isPlain(flags) && (flags & wish) == wish &&
          std::ranges::count(types, i) == 0)
        types.push_back(i);
    }
  return types;
}

std::uint64_t usableBytes(const VkPhysicalDeviceMemoryProperties& memory, const VkDeviceSize* budgets,
                          DeviceType type) {
  const bool shared = type == DeviceType::Integrated || type == DeviceType::Cpu;
  std::uint64_t bytes = 0;
  for (std::uint32_t heap = 0; heap < memory.memoryHeapCount; ++heap) {
    const bool holds_buffers =
        std::any_of(memory.memoryTypes, memory.memoryTypes + memory.memoryTypeCount,
                    [&](const VkMemoryType& t) { return t.heapIndex == heap && isPlain(t.propertyFlags); });
    if (!holds_buffers || (!shared && !(memory.memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)))
      continue;
    const std::uint64_t size = memory.memoryHeaps[heap].size;
    bytes += budgets ? std::min<std::uint64_t>(size, budgets[heap]) : size;
  }
  return bytes;
}

}  // namespace rosefusion
