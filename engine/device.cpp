#include "engine/device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "engine/error.h"
#include "engine/physical_device.h"
#include "engine/shared_library.h"

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
        return impl;
      }
  throw DeviceError(DeviceErrorCode::NoDriver,
                    "No Vulkan loader found (libvulkan.so.1); install libvulkan1 and a driver, for example "
                    "mesa-vulkan-drivers, which also runs without a GPU.");
}

vk::raii::Instance makeInstance(const vk::raii::Context& context, bool validation) {
  const vk::ApplicationInfo application("rosefusion", 1, "rosefusion", 1, VK_API_VERSION_1_1);
  std::vector<const char*> layers, extensions;
  if (validation) {
    const auto present = context.enumerateInstanceLayerProperties();
    if (std::none_of(present.begin(), present.end(),
                     [](const auto& l) { return std::strcmp(l.layerName, kValidationLayer) == 0; }))
      throw DeviceError(DeviceErrorCode::NoDriver, std::string(kValidationLayer) +
                                                       " is asked for but not installed; install the package "
                                                       "vulkan-validationlayers or switch validation off.");
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  const DeviceRequirements needs = deviceRequirements();
  vk::InstanceCreateFlags flags;
  for (const auto& extension : context.enumerateInstanceExtensionProperties())
    if (std::strcmp(extension.extensionName, needs.instance_extension_where_offered) == 0) {
      extensions.push_back(needs.instance_extension_where_offered);
      flags = vk::InstanceCreateFlags(needs.instance_flag_with_it);
    }
  try {
    return {context, vk::InstanceCreateInfo(flags, &application, layers, extensions)};
  } catch (const vk::SystemError&) {
    throw DeviceError(
        DeviceErrorCode::NoDriver,
        "No Vulkan driver is installed; install the one of your GPU, or mesa-vulkan-drivers, which "
        "also runs without a GPU.");
  }
}

/// A driver without its hardware makes the loader fail, no driver at all makes the list empty: both mean the
/// same here.
std::vector<vk::raii::PhysicalDevice> physicalDevices(const vk::raii::Instance& instance) {
  try {
    vk::raii::PhysicalDevices found(instance);
    if (!found.empty()) return found;
  } catch (const vk::SystemError&) {
  }
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

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool matches(const DeviceInfo& info, const std::string& select) {
  if (select.empty()) return true;
  if (std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c); }))
    return info.index == std::atoi(select.c_str());
  return lowered(select) == toString(info.type) ||
         lowered(info.name).find(lowered(select)) != std::string::npos;
}

/// Index of the best usable device that matches; throws with each device and the reason against it otherwise.
std::size_t choose(const std::vector<DeviceInfo>& devices, const std::string& select) {
  std::size_t best = devices.size();
  std::string reasons;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& info = devices[i];
    const bool wanted = matches(info, select);
    if (wanted && info.rejected_because.empty()) {
      if (best == devices.size() || info.type < devices[best].type) best = i;
      continue;
    }
    reasons += " [" + std::to_string(info.index) + "] " + info.name + ": " +
               (wanted ? info.rejected_because : "is not '" + select + "'") + ".";
  }
  if (best < devices.size()) return best;
  throw DeviceError(DeviceErrorCode::NoDevice,
                    "No Vulkan device fits; choose another with --device or $ROSEFUSION_DEVICE." + reasons);
}

vk::raii::Device makeDevice(const vk::raii::PhysicalDevice& physical, std::uint32_t family) {
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue({}, family, 1, &priority);
  const auto extensions = extensionsToEnable(physical);
  return {physical, vk::DeviceCreateInfo({}, queue, {}, extensions)};
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

void throwDeviceError(const vk::SystemError& error, const std::string& doing) {
  const auto result = static_cast<vk::Result>(error.code().value());
  if (result == vk::Result::eErrorOutOfDeviceMemory || result == vk::Result::eErrorOutOfHostMemory)
    throw DeviceError(
        DeviceErrorCode::OutOfMemory,
        "Device memory is exhausted while " + doing +
            "; make volume.voxel_size larger, depth.max smaller, or close other programs on the GPU.");
  if (result == vk::Result::eErrorDeviceLost)
    throw DeviceError(DeviceErrorCode::DeviceLost,
                      "The driver lost the device while " + doing +
                          "; look for a GPU reset in the system log and update the driver.");
  throw DeviceError(DeviceErrorCode::Programming,
                    "Vulkan refused " + doing + " (" + vk::to_string(result) + ").");
}

std::vector<DeviceInfo> listDevices(const DeviceLimits& limits_at_most) {
  const auto impl = openLoader();
  impl->instance = makeInstance(impl->context, false);
  std::vector<DeviceInfo> devices;
  for (const auto& physical : physicalDevices(impl->instance))
    devices.push_back(describe(physical, static_cast<int>(devices.size()), limits_at_most));
  return devices;
}

void Device::Impl::open(std::uint32_t family, vk::Queue caller_queue) {
  memory = physical.getMemoryProperties();
  queue_family = family;
  queue = caller_queue ? vk::raii::Queue(device, caller_queue) : device.getQueue(family, 0);
  if (pipeline_cache) return;
  own_pipeline_cache = {device, vk::PipelineCacheCreateInfo(), allocator};
  pipeline_cache = *own_pipeline_cache;
}

void Device::Impl::submit(const vk::SubmitInfo& work, vk::Fence fence) {
  const std::lock_guard ours(queue_mutex);
  if (lock_queue) lock_queue();
  const std::shared_ptr<void> theirs(nullptr, [&](void*) {
    if (unlock_queue) unlock_queue();
  });
  queue.submit(work, fence);
}

Device::Device(const DeviceOptions& options) : impl_(openLoader()) {
  Impl& d = *impl_;
  d.instance = makeInstance(d.context, options.validation);
  if (options.validation) {
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    d.messenger = {d.instance, vk::DebugUtilsMessengerCreateInfoEXT({}, Severity::eWarning | Severity::eError,
                                                                    Type::eValidation | Type::ePerformance,
                                                                    keepMessage, &d.validation_messages)};
  }
  std::vector<DeviceInfo> infos;
  std::vector<vk::raii::PhysicalDevice> physicals;
  for (auto& physical : physicalDevices(d.instance)) {
    infos.push_back(describe(physical, static_cast<int>(infos.size()), options.limits_at_most));
    physicals.push_back(std::move(physical));
  }
  const char* environment = std::getenv("ROSEFUSION_DEVICE");
  const std::size_t chosen =
      choose(infos, options.select.empty() && environment ? environment : options.select);
  d.physical = std::move(physicals[chosen]);
  d.info = infos[chosen];
  const auto family = static_cast<std::uint32_t>(computeQueueFamily(d.physical));
  try {
    d.device = makeDevice(d.physical, family);
    d.open(family, nullptr);
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "opening the device " + d.info.name);
  }
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
const std::vector<std::string>& Device::validationMessages() const {
  return impl_->validation_messages;
}

}  // namespace rosefusion
