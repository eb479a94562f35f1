// Which of a device's memory types a buffer lies in, and how much memory there is in all; included by
// engine/*.cpp and its tests only.
#pragma once
#include <vulkan/vulkan_core.h>

#include <vector>

#include "engine/buffer.h"

namespace rosefusion {

/// The types for a buffer of `bytes`, the best first, for the next to be tried where an allocation fails.
/// `allowed`: VkMemoryRequirements::memoryTypeBits.
std::vector<std::uint32_t> memoryTypesFor(Memory use, std::uint64_t bytes,
                                          const VkPhysicalDeviceMemoryProperties& memory,
                                          std::uint32_t allowed);

/// What buffers of the device can fill: its own heaps, and all where host and device share their memory.
/// `budgets`: what this process may use of each heap (VK_EXT_memory_budget), null where that is not known.
std::uint64_t usableBytes(const VkPhysicalDeviceMemoryProperties& memory, const VkDeviceSize* budgets,
                          DeviceType type);

}  // namespace rosefusion
