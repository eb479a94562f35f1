// Vulkan handles that the caller made and keeps: what it takes to run the engine on them.
#pragma once
#include <vulkan/vulkan_core.h>

#include <functional>
#include <string>
#include <vector>

#include "engine/device.h"

namespace rosefusion {

/// Everything here stays the caller's: it must outlive the Device made from it, and is never destroyed, reset
/// or waited for as a whole. What the engine makes of its own goes with the engine's objects.
struct CallerDevice {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  /// VkApplicationInfo::apiVersion that the instance was made with; at least 1.1.
  std::uint32_t api_version = VK_API_VERSION_1_1;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< of `queue_family`, which must offer compute
  std::uint32_t queue_family = 0;
  const VkAllocationCallbacks* allocator = nullptr;  ///< copied; for every object that the engine makes
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;   ///< null: the engine has one of its own
  /// Called around each use of the queue, from the thread that uses it; both empty when the engine alone
  /// submits to it. Not held while anything is waited for.
  std::function<void()> lock_queue, unlock_queue;
};

/// What a caller's instance and device must have been made with. No feature and no extension of Vulkan 1.1 is
/// needed.
struct DeviceRequirements {
  std::uint32_t api_version = VK_API_VERSION_1_1;  ///< of the instance and of the device
  VkQueueFlags queue_flags = VK_QUEUE_COMPUTE_BIT;
  VkPhysicalDeviceFeatures features{};                ///< all off
  std::vector<const char*> extensions_where_offered;  ///< to be enabled on devices that offer them
  /// To be enabled on the instance, with the flag, where the loader offers it: else it hides MoltenVK.
  /// (Spelt out, since Vulkan's headers know both from 1.3.208 on only.)
  const char* instance_extension_where_offered = "VK_KHR_portability_enumeration";
  VkInstanceCreateFlags instance_flag_with_it = 1;  ///< VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR
  DeviceLimits limits;                              ///< at least these; 0: any
};
DeviceRequirements deviceRequirements();

/// What is missing, one clause each, before any device is made: reads only get_instance_proc_addr, instance,
/// api_version, physical_device and queue_family. Empty when a Device can be made. Throws DeviceError
/// (Programming) for null handles among these.
std::vector<std::string> missingOf(const CallerDevice& caller);

struct SemaphorePoint {
  VkSemaphore semaphore = VK_NULL_HANDLE;
  std::uint64_t value = 0;  ///< of a timeline semaphore; 0: a binary one
};
/// Makes all that is submitted to the Device's queue from now on wait for `wait`, and signals `signal` when
/// all that was submitted before has run. Does not wait itself. Throws DeviceError.
void submitSemaphores(Device& device, const std::vector<SemaphorePoint>& wait,
                      const std::vector<SemaphorePoint>& signal);

}  // namespace rosefusion
