// What a physical device offers, and whether that is enough; included by engine/*.cpp only.
#pragma once
#include <span>

#include "engine/caller_device.h"
#include "engine/vulkan.h"

namespace rosefusion {

/// Index of the first family with all of DeviceRequirements::queue_flags; -1 when there is none.
int computeQueueFamily(const vk::raii::PhysicalDevice& physical);

/// `index` as in DeviceInfo. `rejected_because` holds all that missingOf() names.
DeviceInfo describe(const vk::raii::PhysicalDevice& physical, int index, const DeviceLimits& limits_at_most);

/// One clause for each thing that the device has not, or less of than rosefusion needs; empty when it can be
/// used.
std::vector<std::string> missingOf(const vk::raii::PhysicalDevice& physical, const DeviceLimits& limits);

/// Extensions that must be enabled where the device offers them.
std::vector<const char*> extensionsToEnable(const vk::raii::PhysicalDevice& physical);

std::string versionText(std::uint32_t version);
std::string joined(std::span<const std::string> clauses);

}  // namespace rosefusion
