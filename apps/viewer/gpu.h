// The Vulkan device that the viewer draws with and the engine computes on.
#pragma once
#include <vulkan/vulkan.h>

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "engine/caller_device.h"

namespace rosefusion::viewer {

/// Throws DeviceError when a Vulkan call failed; `doing` completes "... failed while <doing>".
void require(VkResult result, const char* doing);

struct GpuOptions {
  std::string select;                           ///< a device's index or a part of its name; empty: the best
  bool validation = false;                      ///< the validation layer's messages go to the log
  std::vector<const char*> surface_extensions;  ///< of the instance; empty: without windows
  /// Makes a surface once the instance is there; the device must be able to present to it.
  std::function<VkSurfaceKHR(VkInstance)> make_surface;
};

/// Instance, device and one queue, which every thread uses under queue_mutex.
class Gpu {
 public:
  explicit Gpu(const GpuOptions& options);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  /// For Device's constructor. The Device must go before this.
  CallerDevice callerDevice();
  /// Submits to the queue. `fence` is signalled when it has run.
  void submit(const VkSubmitInfo& submission, VkFence fence);
  /// Before what the device may still use is destroyed. Does not throw.
  void waitUntilIdle();
  std::uint32_t memoryType(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;
  /// What the validation layer said, warnings and errors.
  const std::vector<std::string>& validationMessages() const { return messages_; }

  VkInstance instance = VK_NULL_HANDLE;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  std::mutex queue_mutex;

 private:
  Gpu() = default;  // where an exception ends the other constructor, the destructor cleans up
  void makeInstance(const GpuOptions& options);
  void chooseDevice(const GpuOptions& options);
  void makeDevice();
  bool findQueue(VkPhysicalDevice candidate, std::uint32_t& family) const;

  VkPhysicalDevice chosen_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::vector<std::string> messages_;
};

}  // namespace rosefusion::viewer
