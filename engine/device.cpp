#include "engine/device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "engine/error.h"
#include "engine/physical_device.h"
#include "engine/shared_library.h"
#include "engine/vulkan.h"

namespace rosefusion {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

/// The system's Vulkan loader, opened anew; the last Impl that holds it closes it.
std::unique_ptr<Device::Impl> openLoader() {
  for (const char* name :
       {"libvulkan.so.1", "libvulkan.so", "libvulkan.1.dylib", "libMoltenVK.dylib", "vulkan-1.dll"})
    if (const std::shared_ptr<void> library = openLibrary(name))
      if (void* entry = functionOf(library, "vkGetInstanceProcAddr")) {
        auto impl = std::make_unique<Device::Impl>(reinterpret_cast<PFN_vkGetInstanceProcAddr>(entry));
        impl->loader = library;
        impl->owns_handles = true;
        return impl;
      }
  throw DeviceError(DeviceErrorCode::NoDriver,
                    "No Vulkan loader found (libvulkan.so.1); install libvulkan1 and a driver, for example "
                    "mesa-vulkan-drivers, which also runs without a GPU.");
}

void makeInstance(Device::Impl& d, bool validation) {
  const DeviceRequirements needs = deviceRequirements();
  std::uint32_t version = VK_API_VERSION_1_0;  // whose loaders do not know the command
  if (d.vk.EnumerateInstanceVersion) d.vk.EnumerateInstanceVersion(&version);
  if (version < needs.api_version)
    throw DeviceError(DeviceErrorCode::NoDriver,
                      "The Vulkan loader here offers Vulkan " + versionText(version) + ", rosefusion needs " +
                          versionText(needs.api_version) + "; install a newer libvulkan1.");
  std::vector<const char*> layers, extensions;
  if (validation) {
    const auto present = enumerate<VkLayerProperties>(d.vk.EnumerateInstanceLayerProperties);
    if (std::none_of(present.begin(), present.end(),
                     [](const auto& l) { return std::strcmp(l.layerName, kValidationLayer) == 0; }))
      throw DeviceError(DeviceErrorCode::NoDriver, std::string(kValidationLayer) +
                                                       " is asked for but not installed; install the package "
                                                       "vulkan-validationlayers or switch validation off.");
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  const VkApplicationInfo application{
      VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "rosefusion", 1, "rosefusion", 1, needs.api_version};
  VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                            .pApplicationInfo = &application};
  for (const auto& extension :
       enumerate<VkExtensionProperties>(d.vk.EnumerateInstanceExtensionProperties, nullptr))
    if (std::strcmp(extension.extensionName, needs.instance_extension_where_offered) == 0) {
      extensions.push_back(needs.instance_extension_where_offered);
      info.flags = needs.instance_flag_with_it;
    }
  info.enabledLayerCount = static_cast<std::uint32_t>(layers.size());
  info.ppEnabledLayerNames = layers.data();
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  if (const VkResult result = d.vk.CreateInstance(&info, nullptr, &d.instance); result != VK_SUCCESS) {
    d.instance = nullptr;
    if (isOutOfMemory(result)) require(result, "loading the drivers");
    throw DeviceError(
        DeviceErrorCode::NoDriver,
        "No Vulkan driver is installed; install the one of your GPU, or mesa-vulkan-drivers, which "
        "also runs without a GPU.");
  }
  d.vk.loadFor(d.instance);
}

/// A driver without its hardware makes the loader fail, no driver at all makes the list empty: both mean the
/// same here.
std::vector<VkPhysicalDevice> physicalDevices(const Device::Impl& d) {
  auto found = enumerate<VkPhysicalDevice>(d.vk.EnumeratePhysicalDevices, d.instance);
  if (!found.empty()) return found;
  throw DeviceError(DeviceErrorCode::NoDriver,
                    "No installed Vulkan driver finds a device; install the driver of your "
                    "GPU, or mesa-vulkan-drivers, which also runs without a GPU.");
}

VKAPI_ATTR VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                           VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  static std::mutex mutex;  // layers speak on whatever thread they are called
  const std::lock_guard lock(mutex);
  static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
  return VK_FALSE;
}

void listen(Device::Impl& d) {
  const VkDebugUtilsMessengerCreateInfoEXT info{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType =
          VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = keepMessage,
      .pUserData = &d.validation_messages};
  require(d.vk.CreateDebugUtilsMessengerEXT(d.instance, &info, nullptr, &d.messenger),
          "listening to the validation layer");
}

void makeDevice(Device::Impl& d, std::uint32_t family, std::string_view doing) {
  const float priority = 1;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = family,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const auto extensions = extensionsToEnable(d.vk, d.physical);
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  require(d.vk.CreateDevice(d.physical, &info, nullptr, &d.device), doing);
}

}  // namespace

const char* toString(DeviceType type) {
  switch (type) {
    case DeviceType::Discrete:
      return "discrete";
    case DeviceType::Integrated:
      return "integrated";
    case DeviceType::Virtual:
      return "virtual";
    case DeviceType::Cpu:
      return "cpu";
    case DeviceType::Other:
      break;
  }
  return "other";
}

bool isOutOfMemory(int vk_result) {
  switch (vk_result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_MEMORY_MAP_FAILED:
    case VK_ERROR_TOO_MANY_OBJECTS:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_FRAGMENTATION:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return true;
    default:
      return false;
  }
}

void require(VkResult result, std::string_view doing) {
  if (result == VK_SUCCESS) return;
  if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_MEMORY_MAP_FAILED)
    throw DeviceError(DeviceErrorCode::OutOfMemory,
                      "The driver finds no more of the host's memory while " + std::string(doing) +
                          "; make volume.voxel_size larger, depth.max smaller, or close other programs.");
  if (isOutOfMemory(result))
    throw DeviceError(
        DeviceErrorCode::OutOfMemory,
        "Device memory is exhausted while " + std::string(doing) +
            "; make volume.voxel_size larger, depth.max smaller, or close other programs on the GPU.");
  if (result == VK_ERROR_DEVICE_LOST)
    throw DeviceError(DeviceErrorCode::DeviceLost,
                      "The driver lost the device while " + std::string(doing) +
                          "; look for a GPU reset in the system log and update the driver.");
  if (result == VK_ERROR_INITIALIZATION_FAILED || result == VK_ERROR_UNKNOWN)
    throw DeviceError(result == VK_ERROR_UNKNOWN ? DeviceErrorCode::DeviceLost : DeviceErrorCode::NoDevice,
                      "The driver failed while " + std::string(doing) +
                          "; update it, or choose another device ('rosefusion devices' lists them).");
  throw DeviceError(DeviceErrorCode::Programming,
                    "Vulkan refused " + std::string(doing) + " (VkResult " + std::to_string(result) + ").");
}

std::vector<DeviceInfo> listDevices(const DeviceLimits& limits_at_most) {
  const auto impl = openLoader();
  makeInstance(*impl, false);
  std::vector<DeviceInfo> devices;
  for (const VkPhysicalDevice physical : physicalDevices(*impl))
    devices.push_back(describe(impl->vk, physical, static_cast<int>(devices.size()), limits_at_most));
  return devices;
}

Device::Impl::~Impl() {
  own_pipeline_cache = {};
  if (!owns_handles) return;
  if (device) vk.DestroyDevice(device, nullptr);
  if (messenger) vk.DestroyDebugUtilsMessengerEXT(instance, messenger, nullptr);
  if (instance) vk.DestroyInstance(instance, nullptr);
}

void Device::Impl::open(std::uint32_t family, VkQueue callers_queue, std::string_view doing) {
  vk.loadFor(device);
  vk.GetPhysicalDeviceMemoryProperties(physical, &memory);
  queue_family = family;
  queue = callers_queue;
  if (!queue) vk.GetDeviceQueue(device, family, 0, &queue);
  if (pipeline_cache) return;
  own_pipeline_cache = {
      *this, VkPipelineCacheCreateInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO}, doing};
  pipeline_cache = own_pipeline_cache;
}

VkResult Device::Impl::submit(const VkSubmitInfo& batch, VkFence fence) {
  const std::lock_guard ours(queue_mutex);
  if (lock_queue) lock_queue();
  const std::shared_ptr<void> theirs(nullptr, [&](void*) {
    if (unlock_queue) unlock_queue();
  });
  return vk.QueueSubmit(queue, 1, &batch, fence);
}

Device::Device(const DeviceOptions& options) : impl_(openLoader()) {
  Impl& d = *impl_;
  makeInstance(d, options.validation);
  if (options.validation) listen(d);
  std::vector<DeviceInfo> infos;
  const auto physicals = physicalDevices(d);
  for (const VkPhysicalDevice physical : physicals)
    infos.push_back(describe(d.vk, physical, static_cast<int>(infos.size()), options.limits_at_most));
  const char* environment = std::getenv("ROSEFUSION_DEVICE");
  const std::size_t chosen =
      chooseDevice(infos, options.select.empty() && environment ? environment : options.select);
  d.physical = physicals[chosen];
  d.info = infos[chosen];
  const auto family = static_cast<std::uint32_t>(computeQueueFamily(d.vk, d.physical));
  const std::string doing = "opening the device " + d.info.name;
  makeDevice(d, family, doing);
  d.open(family, nullptr, doing);
}

Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const DeviceInfo& Device::info() const {
  return impl_->info;
}
std::uint64_t Device::allocatedBytes() const {
  return impl_->allocated_bytes;
}
DeviceWork Device::work() const {
  return {impl_->work.submits, impl_->work.dispatches, impl_->work.copied_bytes};
}
const std::vector<std::string>& Device::validationMessages() const {
  return impl_->validation_messages;
}

}  // namespace rosefusion
