// What a physical device offers, and whether that is enough; included by engine/*.cpp only.
#pragma once
#include <span>

#include "engine/caller_device.h"
#include "engine/commands.h"

namespace rosefusion {

std::vector<VkQueueFamilyProperties> queueFamilies(const Commands& vk, VkPhysicalDevice physical);

/// Index of the first family with all of DeviceRequirements::queue_flags; -1 when there is none.
int computeQueueFamily(const Commands& vk, VkPhysicalDevice physical);

/// `index` as in DeviceInfo. `rejected_because` holds all that missingOf() names.
DeviceInfo describe(const Commands& vk, VkPhysicalDevice physical, int index,
                    const DeviceLimits& limits_at_most);

/// One clause for each thing that the device has not, or less of than rosefusion needs; empty when it can be
/// used.
std::vector<std::string> missingOf(const Commands& vk, VkPhysicalDevice physical, const DeviceLimits& limits);

/// Position of the best usable one that DeviceOptions::select names. Throws DeviceError (NoDevice) with each
/// and the reason against it.
std::size_t chooseDevice(const std::vector<DeviceInfo>& devices, const std::string& select);

/// Extensions that must be enabled where the device offers them.
std::vector<const char*> extensionsToEnable(const Commands& vk, VkPhysicalDevice physical);

/// All that a command of Vulkan's lists, asked for their number first; none where it fails.
template <typename T, typename Command, typename... Of>
std::vector<T> enumerate(Command command, Of... of) {
  const auto succeeds = [&](std::uint32_t* count, T* into) {
    if constexpr (std::is_void_v<decltype(command(of..., count, into))>) {
      command(of..., count, into);
      return true;
    } else {
      const VkResult result = command(of..., count, into);
      return result == VK_SUCCESS || result == VK_INCOMPLETE;
    }
  };
  std::uint32_t count = 0;
  if (!succeeds(&count, nullptr) || count == 0)
    return {};  // data() of nothing would ask for the number again
  std::vector<T> list(count);
  if (!succeeds(&count, list.data())) return {};
  list.resize(count);
  return list;
}

std::string versionText(std::uint32_t version);
std::string joined(std::span<const std::string> clauses);

}  // namespace rosefusion
