#include "tests/engine/caller.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace rosefusion::testing {
namespace {

void require(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string("the test's own Vulkan failed: ") + what);
}

VKAPI_ATTR VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                           VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  static std::mutex mutex;  // layers speak on whatever thread they are called
  const std::lock_guard lock(mutex);
  static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
  return VK_FALSE;
}

// $ROSEFUSION_DEVICE is a part of the name, a type or an index.
bool isMeant(const char* wanted, const VkPhysicalDeviceProperties& properties, std::uint32_t index) {
  static const char* const kTypes[] = {"other", "integrated", "discrete", "virtual",
                                       "cpu"};  // as Vulkan's values
  return wanted == std::to_string(index) || wanted == std::string(kTypes[properties.deviceType]) ||
         std::strstr(properties.deviceName, wanted);
}

// Sizes are kept in front of what is handed out, so that reallocation can copy. Counters: live, made.
struct Counts {
  int* live;
  int* made;
  std::mutex mutex;
};
constexpr std::size_t kFront = 64;

void* VKAPI_CALL allocate(void* user, std::size_t bytes, std::size_t, VkSystemAllocationScope) {
  auto* counts = static_cast<Counts*>(user);
  char* memory = static_cast<char*>(std::aligned_alloc(kFront, (bytes + 2 * kFront - 1) / kFront * kFront));
  std::memcpy(memory, &bytes, sizeof bytes);
  const std::lock_guard lock(counts->mutex);
  ++*counts->live;
  ++*counts->made;
  return memory + kFront;
}
void VKAPI_CALL release(void* user, void* memory) {
  if (!memory) return;
  auto* counts = static_cast<Counts*>(user);
  std::free(static_cast<char*>(memory) - kFront);
  const std::lock_guard lock(counts->mutex);
  --*counts->live;
}
void* VKAPI_CALL reallocate(void* user, void* old, std::size_t bytes, std::size_t alignment,
                            VkSystemAllocationScope scope) {
  void* fresh = bytes ? allocate(user, bytes, alignment, scope) : nullptr;
  if (old && fresh) {
    std::size_t before = 0;
    std::memcpy(&before, static_cast<char*>(old) - kFront, sizeof before);
    std::memcpy(fresh, old, std::min(before, bytes));
  }
  release(user, old);
  return fresh;
}

}  // namespace

Caller::Caller(bool with_validation, bool timeline)
    : loader_(dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL), dlclose) {
  get_ = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader_.get(), "vkGetInstanceProcAddr"));
  callbacks_ = {new Counts{&live_, &made_, {}}, allocate, reallocate, release, nullptr, nullptr};
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.apiVersion = VK_API_VERSION_1_1;
  const char* layer = "VK_LAYER_KHRONOS_validation";
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkValidationFeatureEnableEXT synchronisation =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT validation{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  validation.enabledValidationFeatureCount = 1;
  validation.pEnabledValidationFeatures = &synchronisation;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, with_validation ? &validation : nullptr};
  info.pApplicationInfo = &application;
  info.enabledLayerCount = info.enabledExtensionCount = with_validation;
  info.ppEnabledLayerNames = &layer;
  info.ppEnabledExtensionNames = &extension;
  require(command<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance), "instance");
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = keepMessage;
  messenger.pUserData = &messages_;
  if (with_validation)
    require(command<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(
                instance, &messenger, nullptr, &messenger_),
            "messenger");

  const char* chosen = std::getenv("ROSEFUSION_DEVICE");
  std::uint32_t count = 8;
  VkPhysicalDevice all[8];
  command<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance, &count, all);
  for (std::uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties;
    command<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(all[i], &properties);
    if (isMeant(chosen ? chosen : "llvmpipe", properties, i)) physical = all[i];
  }
  if (!physical) throw std::runtime_error("the test's own Vulkan finds not the device under test");
  const float priority = 1;
  VkDeviceQueueCreateInfo queue_info{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue_info.queueCount = 1;
  queue_info.pQueuePriorities = &priority;
  VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  device_info.queueCreateInfoCount = 1;
  device_info.pQueueCreateInfos = &queue_info;
  VkPhysicalDeviceTimelineSemaphoreFeatures timelines{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES};
  timelines.timelineSemaphore = VK_TRUE;
  const char* timeline_extension = VK_KHR_TIMELINE_SEMAPHORE_EXTENSION_NAME;
  if (timeline) {
    device_info.pNext = &timelines;
    device_info.enabledExtensionCount = 1;
    device_info.ppEnabledExtensionNames = &timeline_extension;
  }
  require(command<PFN_vkCreateDevice>("vkCreateDevice")(physical, &device_info, nullptr, &device), "device");
  command<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device, 0, 0, &queue);
  const VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  require(command<PFN_vkCreateCommandPool>("vkCreateCommandPool")(device, &pool, nullptr, &pool_), "pool");
}

Caller::~Caller() {
  for (const VkImage image : images_) command<PFN_vkDestroyImage>("vkDestroyImage")(device, image, nullptr);
  for (const VkDeviceMemory memory : memory_)
    command<PFN_vkFreeMemory>("vkFreeMemory")(device, memory, nullptr);
  command<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(device, pool_, nullptr);
  command<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
  if (messenger_)
    command<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance, messenger_,
                                                                                    nullptr);
  command<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
  delete static_cast<Counts*>(callbacks_.pUserData);
}

CallerDevice Caller::handles() const {
  CallerDevice out;
  out.get_instance_proc_addr = get_;
  out.instance = instance;
  out.physical_device = physical;
  out.device = device;
  out.queue = queue;
  return out;
}

PFN_vkVoidFunction Caller::find(const char* name) const {
  return get_(instance, name);
}

VkCommandBuffer Caller::beginFrame() {
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = pool_;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  require(command<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(device, &info, &commands),
          "command buffer");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  require(command<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, &begin), "begin");
  return commands;
}

void Caller::endFrame(VkCommandBuffer commands) {
  require(command<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands), "end");
  VkSubmitInfo work{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  work.commandBufferCount = 1;
  work.pCommandBuffers = &commands;
  const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence done = VK_NULL_HANDLE;
  require(command<PFN_vkCreateFence>("vkCreateFence")(device, &info, nullptr, &done), "fence");
  {
    const std::lock_guard lock(queue_mutex);
    require(command<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, 1, &work, done), "submit");
  }
  require(command<PFN_vkWaitForFences>("vkWaitForFences")(device, 1, &done, VK_TRUE, ~0ull), "wait");
  command<PFN_vkDestroyFence>("vkDestroyFence")(device, done, nullptr);
  command<PFN_vkFreeCommandBuffers>("vkFreeCommandBuffers")(device, pool_, 1, &commands);
}

VkDeviceMemory Caller::allocateFor(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties types;
  command<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(physical, &types);
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = needs.size;
  while (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1u) ||
         (types.memoryTypes[info.memoryTypeIndex].propertyFlags & flags) != flags)
    if (++info.memoryTypeIndex == types.memoryTypeCount) throw std::runtime_error("no memory for the test");
  VkDeviceMemory memory = VK_NULL_HANDLE;
  require(command<PFN_vkAllocateMemory>("vkAllocateMemory")(device, &info, nullptr, &memory), "memory");
  memory_.push_back(memory);
  return memory;
}

void Caller::transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect,
                        VkImageLayout from, VkImageLayout to) const {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, 1, 0, 1};
  command<PFN_vkCmdPipelineBarrier>("vkCmdPipelineBarrier")(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                                            VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0,
                                                            nullptr, 1, &barrier);
}

VkImage Caller::makeImage(VkFormat format, VkImageAspectFlags aspect, std::uint32_t width,
                          std::uint32_t height) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {width, height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  VkImage image = VK_NULL_HANDLE;
  require(command<PFN_vkCreateImage>("vkCreateImage")(device, &info, nullptr, &image), "image");
  images_.push_back(image);
  VkMemoryRequirements needs;
  command<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(device, image, &needs);
  command<PFN_vkBindImageMemory>("vkBindImageMemory")(device, image, allocateFor(needs, 0), 0);
  frame([&](VkCommandBuffer commands) {
    transition(commands, image, aspect, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  });
  return image;
}

std::vector<std::uint32_t> Caller::read(VkImage image, VkImageAspectFlags aspect, std::uint32_t width,
                                        std::uint32_t height) {
  std::vector<std::uint32_t> words(std::size_t(width) * height);
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = 4 * words.size();
  info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  require(command<PFN_vkCreateBuffer>("vkCreateBuffer")(device, &info, nullptr, &buffer), "buffer");
  VkMemoryRequirements needs;
  command<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(device, buffer, &needs);
  const VkDeviceMemory memory =
      allocateFor(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  command<PFN_vkBindBufferMemory>("vkBindBufferMemory")(device, buffer, memory, 0);
  frame([&](VkCommandBuffer commands) {
    transition(commands, image, aspect, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const VkBufferImageCopy whole{0, 0, 0, {aspect, 0, 0, 1}, {0, 0, 0}, {width, height, 1}};
    command<PFN_vkCmdCopyImageToBuffer>("vkCmdCopyImageToBuffer")(
        commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &whole);
    transition(commands, image, aspect, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  });
  void* mapped = nullptr;
  require(command<PFN_vkMapMemory>("vkMapMemory")(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "map");
  std::memcpy(words.data(), mapped, 4 * words.size());
  command<PFN_vkUnmapMemory>("vkUnmapMemory")(device, memory);
  command<PFN_vkDestroyBuffer>("vkDestroyBuffer")(device, buffer, nullptr);
  return words;
}

bool Caller::works() const {
  VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence fence = VK_NULL_HANDLE;
  if (command<PFN_vkCreateFence>("vkCreateFence")(device, &info, nullptr, &fence) != VK_SUCCESS) return false;
  const bool ran =
      command<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, 0, nullptr, fence) == VK_SUCCESS &&
      command<PFN_vkWaitForFences>("vkWaitForFences")(device, 1, &fence, VK_TRUE, ~0ull) == VK_SUCCESS;
  command<PFN_vkDestroyFence>("vkDestroyFence")(device, fence, nullptr);
  return ran;
}

}  // namespace rosefusion::testing
