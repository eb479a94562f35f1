// The application's own Vulkan: what an engine has before it knows of rosefusion. Raw Vulkan 1.1.
#pragma once
#include <mutex>
#include <string>
#include <vector>

#include "rosefusion/vulkan.h"

namespace renderer {

/// Throws std::runtime_error that names what failed.
void require(VkResult result, const char* doing);

struct Image {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
};
struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  void* mapped = nullptr;
};

struct ApplicationOptions {
  bool validation = false;  ///< with synchronisation validation; what it says is in messages()
  std::vector<const char*> instance_extensions;
  bool swapchain = false;
};

/// Instance, device, one queue for graphics and compute, one command buffer. One thread, but for submit().
class Application {
 public:
  /// On the first device ($ROSEFUSION_DEVICE: whose name holds that) that missingFor() has nothing against.
  /// Throws std::runtime_error naming each device and why it is not used.
  explicit Application(const ApplicationOptions& options);
  ~Application();
  Application(const Application&) = delete;

  /// For the Reconstructor; it and this class take turns at the queue.
  rosefusion::VulkanHandles handles();

  /// The command buffer, begun, when the work of the last frame has ended.
  VkCommandBuffer beginFrame();
  /// Submits it. `wait` and `signal` may be null.
  void endFrame(VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);
  void waitForFrame();
  /// The queue, to be used while the lock is held.
  std::unique_lock<std::mutex> lockQueue() { return std::unique_lock(queue_mutex_); }

  Image makeImage(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect, VkExtent2D size);
  HostBuffer makeHostBuffer(VkDeviceSize bytes, VkBufferUsageFlags usage);
  void destroy(const Image& image);
  void destroy(const HostBuffer& buffer);

  const std::vector<std::string>& messages() const { return messages_; }

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;

 private:
  void makeInstance(const ApplicationOptions& options);
  void choosePhysicalDevice();
  void makeDevice(bool swapchain);
  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags);

  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence done_ = VK_NULL_HANDLE;
  bool in_flight_ = false;
  std::mutex queue_mutex_;
  std::vector<std::string> messages_;
};

/// An image barrier of the whole image.
void transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from,
                VkImageLayout to, VkPipelineStageFlags before, VkAccessFlags written,
                VkPipelineStageFlags after, VkAccessFlags accessed);

}  // namespace renderer
