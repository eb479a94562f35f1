#include "apps/renderer/application.h"

#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace renderer {
namespace {

VKAPI_ATTR VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                           VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  static std::mutex mutex;  // layers speak on whatever thread they are called
  const std::lock_guard lock(mutex);
  static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
  return VK_FALSE;
}

/// First family for graphics and compute; -1 when there is none.
int familyOf(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::uint32_t i = 0; i < count; ++i)
    if ((families[i].queueFlags & kNeeded) == kNeeded) return static_cast<int>(i);
  return -1;
}

/// Whether $ROSEFUSION_DEVICE, a part of the name, a type or an index, means this device.
bool isMeant(const char* wanted, const VkPhysicalDeviceProperties& properties, std::uint32_t index) {
  static const char* const kTypes[] = {"other", "integrated", "discrete", "virtual",
                                       "cpu"};  // as Vulkan's values
  return wanted == std::to_string(index) || wanted == std::string(kTypes[properties.deviceType]) ||
         std::strstr(properties.deviceName, wanted);
}

}  // namespace

void require(VkResult result, const char* doing) {
  if (result < 0)
    throw std::runtime_error(std::string(doing) + " failed (VkResult " + std::to_string(result) + ").");
}

Application::Application(const ApplicationOptions& options) {
  makeInstance(options);
  choosePhysicalDevice();
  makeDevice(options.swapchain);
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = family;
  require(vkCreateCommandPool(device, &pool, nullptr, &pool_), "Making a command pool");
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = pool_;
  info.commandBufferCount = 1;
  require(vkAllocateCommandBuffers(device, &info, &commands_), "Making a command buffer");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  require(vkCreateFence(device, &fence, nullptr, &done_), "Making a fence");
}

Application::~Application() {
  waitForFrame();
  vkDestroyFence(device, done_, nullptr);
  vkDestroyCommandPool(device, pool_, nullptr);
  vkDestroyDevice(device, nullptr);
  if (messenger_)
    reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"))(instance, messenger_, nullptr);
  vkDestroyInstance(instance, nullptr);
}

void Application::makeInstance(const ApplicationOptions& options) {
  const rosefusion::VulkanRequirements needs = rosefusion::vulkanRequirements();
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "rosefusion's example renderer";
  application.apiVersion = needs.api_version;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  std::vector<const char*> extensions = options.instance_extensions;
  std::uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> offered(count);
  vkEnumerateInstanceExtensionProperties(nullptr, &count, offered.data());
  for (const VkExtensionProperties& extension : offered)
    if (std::strcmp(extension.extensionName, needs.instance_extension_where_offered) == 0) {
      extensions.push_back(needs.instance_extension_where_offered);
      info.flags |= needs.instance_flag_with_it;
    }
  const char* layer = "VK_LAYER_KHRONOS_validation";
  const VkValidationFeatureEnableEXT synchronisation =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronisation;
  if (options.validation) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &layer;
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  require(vkCreateInstance(&info, nullptr, &instance), "Making a Vulkan instance");
  if (!options.validation) return;
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = keepMessage;
  messenger.pUserData = &messages_;
  require(reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
              instance, "vkCreateDebugUtilsMessengerEXT"))(instance, &messenger, nullptr, &messenger_),
          "Listening to the validation layer");
}

void Application::choosePhysicalDevice() {
  std::uint32_t count = 0;
  require(vkEnumeratePhysicalDevices(instance, &count, nullptr), "Listing the Vulkan devices");
  std::vector<VkPhysicalDevice> all(count);
  require(vkEnumeratePhysicalDevices(instance, &count, all.data()), "Listing the Vulkan devices");
  const char* wanted = std::getenv("ROSEFUSION_DEVICE");
  std::string reasons;
  for (std::uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(all[i], &properties);
    const int found = familyOf(all[i]);
    physical = all[i];
    family = static_cast<std::uint32_t>(std::max(found, 0));
    std::vector<std::string> against = rosefusion::missingFor(handles());
    if (found < 0) against.push_back("it has no queue for both graphics and compute");
    if (wanted && !isMeant(wanted, properties, i))
      against.push_back("it is not '" + std::string(wanted) + "' ($ROSEFUSION_DEVICE)");
    if (against.empty()) return;
    for (const std::string& reason : against)
      reasons += std::string(" ") + properties.deviceName + ": " + reason + ".";
  }
  throw std::runtime_error("No Vulkan device can be used." + reasons);
}

void Application::makeDevice(bool swapchain) {
  std::vector<const char*> extensions;
  if (swapchain) extensions.push_back("VK_KHR_swapchain");
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> offered(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, offered.data());
  for (const char* name : rosefusion::vulkanRequirements().extensions_where_offered)
    for (const VkExtensionProperties& extension : offered)
      if (std::strcmp(extension.extensionName, name) == 0) extensions.push_back(name);
  const float priority = 1;
  VkDeviceQueueCreateInfo queue_info{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue_info.queueFamilyIndex = family;
  queue_info.queueCount = 1;
  queue_info.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue_info;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  require(vkCreateDevice(physical, &info, nullptr, &device), "Making a Vulkan device");
  vkGetDeviceQueue(device, family, 0, &queue);
}

rosefusion::VulkanHandles Application::handles() {
  rosefusion::VulkanHandles out;
  out.get_instance_proc_addr = vkGetInstanceProcAddr;
  out.instance = instance;
  out.physical_device = physical;
  out.device = device;
  out.queue = queue;
  out.queue_family = family;
  out.lock_queue = [this] { queue_mutex_.lock(); };
  out.unlock_queue = [this] { queue_mutex_.unlock(); };
  return out;
}

VkCommandBuffer Application::beginFrame() {
  waitForFrame();
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  require(vkBeginCommandBuffer(commands_, &begin), "Beginning a frame");
  return commands_;
}

void Application::endFrame(VkSemaphore wait, VkSemaphore signal) {
  require(vkEndCommandBuffer(commands_), "Ending a frame");
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;  // where the window's image is written
  VkSubmitInfo work{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  work.commandBufferCount = 1;
  work.pCommandBuffers = &commands_;
  work.waitSemaphoreCount = wait ? 1 : 0;
  work.pWaitSemaphores = &wait;
  work.pWaitDstStageMask = &stage;
  work.signalSemaphoreCount = signal ? 1 : 0;
  work.pSignalSemaphores = &signal;
  const auto lock = lockQueue();
  require(vkQueueSubmit(queue, 1, &work, done_), "Submitting a frame");
  in_flight_ = true;
}

void Application::waitForFrame() {
  if (!in_flight_) return;
  require(vkWaitForFences(device, 1, &done_, VK_TRUE, ~0ull), "Waiting for a frame");
  require(vkResetFences(device, 1, &done_), "Waiting for a frame");
  in_flight_ = false;
}

VkDeviceMemory Application::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties types;
  vkGetPhysicalDeviceMemoryProperties(physical, &types);
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = needs.size;
  while (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1u) ||
         (types.memoryTypes[info.memoryTypeIndex].propertyFlags & flags) != flags)
    if (++info.memoryTypeIndex == types.memoryTypeCount)
      throw std::runtime_error("The device has no memory of the kind that is needed.");
  VkDeviceMemory memory = VK_NULL_HANDLE;
  require(vkAllocateMemory(device, &info, nullptr, &memory), "Allocating memory");
  return memory;
}

Image Application::makeImage(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
                             VkExtent2D size) {
  Image out;
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {size.width, size.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage;
  require(vkCreateImage(device, &info, nullptr, &out.image), "Making an image");
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device, out.image, &needs);
  out.memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  require(vkBindImageMemory(device, out.image, out.memory, 0), "Making an image");
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = out.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {aspect, 0, 1, 0, 1};
  require(vkCreateImageView(device, &view, nullptr, &out.view), "Making an image");
  return out;
}

HostBuffer Application::makeHostBuffer(VkDeviceSize bytes, VkBufferUsageFlags usage) {
  HostBuffer out;
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes;
  info.usage = usage;
  require(vkCreateBuffer(device, &info, nullptr, &out.buffer), "Making a buffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device, out.buffer, &needs);
  out.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  require(vkBindBufferMemory(device, out.buffer, out.memory, 0), "Making a buffer");
  require(vkMapMemory(device, out.memory, 0, VK_WHOLE_SIZE, 0, &out.mapped), "Making a buffer");
  return out;
}

void Application::destroy(const Image& image) {
  vkDestroyImageView(device, image.view, nullptr);
  vkDestroyImage(device, image.image, nullptr);
  vkFreeMemory(device, image.memory, nullptr);
}

void Application::destroy(const HostBuffer& buffer) {
  vkDestroyBuffer(device, buffer.buffer, nullptr);
  vkFreeMemory(device, buffer.memory, nullptr);
}

void transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from,
                VkImageLayout to, VkPipelineStageFlags before, VkAccessFlags written,
                VkPipelineStageFlags after, VkAccessFlags accessed) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = written;
  barrier.dstAccessMask = accessed;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, before, after, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace renderer
