// An application with a Vulkan device of its own, for tests of the engine on it: raw Vulkan, as few features
// as there can be, synchronisation validation, and a count of what the allocation callbacks saw.
#pragma once
#include <vulkan/vulkan_core.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/caller_device.h"

namespace rosefusion::testing {

class Caller {
 public:
  /// $ROSEFUSION_DEVICE's name, else Mesa's software device. No feature is enabled, and no extension.
  /// `validation`: with the validation layer, synchronisation validation included; else messages() stays
  /// empty.
  /// `timeline`: with timeline semaphores after all (VK_KHR_timeline_semaphore).
  explicit Caller(bool validation = true, bool timeline = false);
  ~Caller();
  Caller(const Caller&) = delete;

  /// Its handles, complete.
  CallerDevice handles() const;
  /// A command by its name, of the device where it is one of the device's.
  template <typename Function>
  Function command(const char* name) const {
    return reinterpret_cast<Function>(find(name));
  }
  /// What the layers said, synchronisation validation included.
  const std::vector<std::string>& messages() const { return messages_; }
  /// Allocations that were made through callbacks() and are not freed yet, and all that were ever made.
  int liveAllocations() const { return live_; }
  int allocations() const { return made_; }
  const VkAllocationCallbacks& callbacks() const { return callbacks_; }
  /// Submits the caller's own work, an empty batch, and waits for it: whether its device and queue still
  /// live.
  bool works() const;

  /// The caller's frame loop, reduced to one frame: a command buffer that `record` fills, submitted and
  /// waited for. beginFrame() and endFrame() are its two halves.
  template <typename Record>
  void frame(Record record) {
    const VkCommandBuffer commands = beginFrame();
    record(commands);
    endFrame(commands);
  }
  VkCommandBuffer beginFrame();
  void endFrame(VkCommandBuffer commands);

  /// A device-local image of 4-byte texels for transfers, in TRANSFER_DST_OPTIMAL; destroyed with the Caller.
  VkImage makeImage(VkFormat format, VkImageAspectFlags aspect, std::uint32_t width, std::uint32_t height);
  /// Its texels as words; it ends in TRANSFER_DST_OPTIMAL again.
  std::vector<std::uint32_t> read(VkImage image, VkImageAspectFlags aspect, std::uint32_t width,
                                  std::uint32_t height);

  /// Records an image's barrier between transfers.
  void transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from,
                  VkImageLayout to) const;

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::mutex queue_mutex;  ///< held while frame() submits, and not while it waits

 private:
  PFN_vkVoidFunction find(const char* name) const;
  VkDeviceMemory allocateFor(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags);

  std::shared_ptr<void> loader_;
  PFN_vkGetInstanceProcAddr get_ = nullptr;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkAllocationCallbacks callbacks_{};
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<VkImage> images_;
  std::vector<VkDeviceMemory> memory_;
  std::vector<std::string> messages_;
  int live_ = 0, made_ = 0;
};

}  // namespace rosefusion::testing
