#include "apps/viewer/gpu.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>

#include "engine/error.h"

namespace rosefusion::viewer {
namespace {

constexpr const char* kValidation = "VK_LAYER_KHRONOS_validation";

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

int preference(VkPhysicalDeviceType type) {
  return type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU     ? 0
         : type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? 1
         : type == VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU    ? 2
         : type == VK_PHYSICAL_DEVICE_TYPE_CPU            ? 3
                                                          : 4;
}

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
  spdlog::error("{}", data->pMessage);
  return VK_FALSE;
}

}  // namespace

void require(VkResult result, const char* doing) {
  if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) return;
  const auto fail = [&](DeviceErrorCode code, const std::string& what, const std::string& remedy) {
    throw DeviceError(code, what + " while " + doing + "; " + remedy + ".");
  };
  if (isOutOfMemory(result))
    fail(DeviceErrorCode::OutOfMemory, "Memory is exhausted",
         "close other programs on the GPU, or make volume.voxel_size larger");
  if (result == VK_ERROR_DEVICE_LOST)
    fail(DeviceErrorCode::DeviceLost, "The driver lost the device",
         "look for a GPU reset in the system log and update the driver");
  fail(DeviceErrorCode::NoDevice, "The driver failed (VkResult " + std::to_string(result) + ")",
       "update it, or choose another device with --device ('rosefusion devices' lists them)");
}

Gpu::Gpu(const GpuOptions& options) : Gpu() {
  makeInstance(options);
  if (options.make_surface) surface = options.make_surface(instance);
  chooseDevice(options);
  makeDevice();
}

Gpu::~Gpu() {
  waitUntilIdle();
  if (device) vkDestroyDevice(device, nullptr);
  if (surface) vkDestroySurfaceKHR(instance, surface, nullptr);
  if (messenger_) {
    const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
    destroy_messenger(instance, messenger_, nullptr);
  }
  if (instance) vkDestroyInstance(instance, nullptr);
}

void Gpu::makeInstance(const GpuOptions& options) {
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "rosefusion-viewer";
  application.apiVersion = VK_API_VERSION_1_1;
  std::vector<const char*> extensions = options.surface_extensions;
  if (options.validation) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  const DeviceRequirements needs = deviceRequirements();
  std::uint32_t count = 0;
  require(vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr), "looking for drivers");
  std::vector<VkExtensionProperties> offered(count);
  if (count > 0)
    require(vkEnumerateInstanceExtensionProperties(nullptr, &count, offered.data()), "looking for drivers");
  for (const VkExtensionProperties& extension : offered)
    if (std::string(extension.extensionName) == needs.instance_extension_where_offered) {
      extensions.push_back(needs.instance_extension_where_offered);
      create.flags |= needs.instance_flag_with_it;
    }
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
  messenger.pfnUserCallback = onMessage;
  messenger.pUserData = &messages_;
  create.pApplicationInfo = &application;
  create.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  create.ppEnabledExtensionNames = extensions.data();
  create.enabledLayerCount = options.validation;
  create.ppEnabledLayerNames = &kValidation;
  const VkResult result = vkCreateInstance(&create, nullptr, &instance);
  if (result == VK_ERROR_LAYER_NOT_PRESENT)
    throw DeviceError(
        DeviceErrorCode::NoDevice,
        "The Vulkan validation layer is not installed; install vulkan-validationlayers or leave out "
        "--validation.");
  if (result != VK_SUCCESS)
    throw DeviceError(DeviceErrorCode::NoDriver,
                      "No Vulkan driver can be used; install one, such as mesa-vulkan-drivers.");
  if (!options.validation) return;
  const auto make = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
  require(make(instance, &messenger, nullptr, &messenger_), "starting the validation layer");
}

/// The viewer draws, computes and presents in one queue.
bool Gpu::findQueue(VkPhysicalDevice candidate, std::uint32_t& family) const {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, families.data());
  for (family = 0; family < count; ++family) {
    const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    VkBool32 presents = !surface;
    if (surface) vkGetPhysicalDeviceSurfaceSupportKHR(candidate, family, surface, &presents);
    if ((families[family].queueFlags & needed) == needed && presents) return true;
  }
  return false;
}

void Gpu::chooseDevice(const GpuOptions& options) {
  std::uint32_t count = 0;
  require(vkEnumeratePhysicalDevices(instance, &count, nullptr), "looking for devices");
  std::vector<VkPhysicalDevice> candidates(count);
  if (count > 0)
    require(vkEnumeratePhysicalDevices(instance, &count, candidates.data()), "looking for devices");
  int best = 5;
  std::string reasons;
  for (std::uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(candidates[i], &properties);
    const std::string name = properties.deviceName;
    const bool chosen = options.select.empty() || options.select == std::to_string(i) ||
                        lower(name).find(lower(options.select)) != std::string::npos;
    if (!chosen) continue;
    physical = candidates[i];
    std::uint32_t family = 0;
    std::vector<std::string> missing;
    if (findQueue(candidates[i], family)) {
      CallerDevice caller = callerDevice();
      caller.queue_family = family;
      missing = missingOf(caller);
    } else {
      missing = {"it has no queue that draws, computes and presents"};
    }
    for (const std::string& clause : missing) reasons += " " + name + ": " + clause + ".";
    if (!missing.empty() || preference(properties.deviceType) >= best) continue;
    best = preference(properties.deviceType);
    queue_family = family;
    vkGetPhysicalDeviceProperties(candidates[i], &properties);
    chosen_ = candidates[i];
  }
  physical = chosen_;
  if (!physical)
    throw DeviceError(
        DeviceErrorCode::NoDevice,
        (options.select.empty() ? std::string("No Vulkan device can be used;")
                                : "No usable Vulkan device is called '" + options.select + "';") +
            " 'rosefusion devices' lists them." + reasons);
}

void Gpu::makeDevice() {
  const float priority = 1;
  VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queues.queueFamilyIndex = queue_family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  std::uint32_t count = 0;
  require(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr), "making the device");
  std::vector<VkExtensionProperties> offered(count);
  if (count > 0)
    require(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, offered.data()),
            "making the device");
  std::vector<const char*> extensions;
  if (surface) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  for (const char* name : deviceRequirements().extensions_where_offered)
    if (std::any_of(offered.begin(), offered.end(),
                    [&](const auto& e) { return std::string(e.extensionName) == name; }))
      extensions.push_back(name);
  VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queues;
  create.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  create.ppEnabledExtensionNames = extensions.data();
  require(vkCreateDevice(physical, &create, nullptr, &device), "making the device");
  vkGetDeviceQueue(device, queue_family, 0, &queue);
}

CallerDevice Gpu::callerDevice() {
  CallerDevice caller;
  caller.get_instance_proc_addr = vkGetInstanceProcAddr;
  caller.instance = instance;
  caller.physical_device = physical;
  caller.device = device;
  caller.queue = queue;
  caller.queue_family = queue_family;
  caller.lock_queue = [this] { queue_mutex.lock(); };
  caller.unlock_queue = [this] { queue_mutex.unlock(); };
  return caller;
}

void Gpu::waitUntilIdle() {
  const std::lock_guard lock(queue_mutex);
  if (queue) (void)vkQueueWaitIdle(queue);  // of a lost device nothing runs any more
}

void Gpu::submit(const VkSubmitInfo& submission, VkFence fence) {
  const std::lock_guard lock(queue_mutex);
  require(vkQueueSubmit(queue, 1, &submission, fence), "drawing");
}

std::uint32_t Gpu::memoryType(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  VkPhysicalDeviceMemoryProperties properties;
  vkGetPhysicalDeviceMemoryProperties(physical, &properties);
  for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
    if (allowed >> i & 1 && (properties.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  throw DeviceError(DeviceErrorCode::MissingLimit, "The device has no memory that fits the viewer's images.");
}

}  // namespace rosefusion::viewer
