#include "engine/device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "engine/error.h"
#include "engine/vulkan.h"

namespace rosefusion {
namespace {

// What the passes need; every desktop and mobile driver known to us has more (spec minima in brackets).
constexpr std::uint32_t kNeededStorageBuffers = 20;   // [4]; integrate binds 17
constexpr std::uint32_t kNeededInvocations = 128;     // [128]
constexpr std::uint32_t kNeededPushConstants = 128;   // [128]
constexpr std::uint32_t kNeededSharedMemory = 16384;  // [16384]
constexpr std::uint64_t kNeededBinding = 128u << 20;  // [2^27]
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

DeviceType typeOf(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return DeviceType::Discrete;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return DeviceType::Integrated;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return DeviceType::Virtual;
    case vk::PhysicalDeviceType::eCpu:
      return DeviceType::Cpu;
    default:
      return DeviceType::Other;
  }
}

std::string versionText(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) +
         "." + std::to_string(VK_API_VERSION_PATCH(version));
}

int computeQueueFamily(const vk::raii::PhysicalDevice& physical) {
  const auto families = physical.getQueueFamilyProperties();
  for (std::size_t i = 0; i < families.size(); ++i)
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return static_cast<int>(i);
  return -1;
}

std::string whyUnusable(const vk::raii::PhysicalDevice& physical, std::uint32_t api_version,
                        const DeviceLimits& limits) {
  const auto below = [](const char* what, std::uint64_t has, std::uint64_t needs) {
    return std::string(what) + " is " + std::to_string(has) + ", rosefusion needs " + std::to_string(needs);
  };
  if (api_version < VK_API_VERSION_1_1)
    return "it offers Vulkan " + versionText(api_version) + ", rosefusion needs 1.1";
  if (computeQueueFamily(physical) < 0) return "it has no compute queue";
  if (limits.max_storage_buffers < kNeededStorageBuffers)
    return below("maxPerStageDescriptorStorageBuffers", limits.max_storage_buffers, kNeededStorageBuffers);
  if (limits.max_workgroup_invocations < kNeededInvocations)
    return below("maxComputeWorkGroupInvocations", limits.max_workgroup_invocations, kNeededInvocations);
  if (limits.max_push_constant_bytes < kNeededPushConstants)
    return below("maxPushConstantsSize", limits.max_push_constant_bytes, kNeededPushConstants);
  if (limits.max_shared_memory_bytes < kNeededSharedMemory)
    return below("maxComputeSharedMemorySize", limits.max_shared_memory_bytes, kNeededSharedMemory);
  if (limits.max_storage_buffer_bytes < kNeededBinding)
    return below("maxStorageBufferRange", limits.max_storage_buffer_bytes, kNeededBinding);
  return "";
}

/// Lowers what `limits` says to what `at_most` says, where that is not 0.
void lower(DeviceLimits& limits, const DeviceLimits& at_most) {
  const auto apply = [](auto& value, auto most) { value = most ? std::min(value, most) : value; };
  apply(limits.max_storage_buffer_bytes, at_most.max_storage_buffer_bytes);
  apply(limits.max_storage_buffers, at_most.max_storage_buffers);
  apply(limits.max_workgroup_invocations, at_most.max_workgroup_invocations);
  apply(limits.max_workgroup_count_x, at_most.max_workgroup_count_x);
  apply(limits.max_push_constant_bytes, at_most.max_push_constant_bytes);
  apply(limits.max_shared_memory_bytes, at_most.max_shared_memory_bytes);
  apply(limits.memory_bytes, at_most.memory_bytes);
  apply(limits.max_allocation_bytes, at_most.max_allocation_bytes);
}

DeviceInfo describe(const vk::raii::PhysicalDevice& physical, int index, const DeviceLimits& limits_at_most) {
  DeviceInfo info;
  info.index = index;
  const auto basic = physical.getProperties();
  info.name = basic.deviceName.data();
  info.type = typeOf(basic.deviceType);
  info.api_version = versionText(basic.apiVersion);
  info.driver = "version " + std::to_string(basic.driverVersion);
  DeviceLimits& limits = info.limits;
  limits.max_storage_buffer_bytes = basic.limits.maxStorageBufferRange;
  limits.max_storage_buffers =
      std::min(basic.limits.maxPerStageDescriptorStorageBuffers, basic.limits.maxDescriptorSetStorageBuffers);
  limits.max_workgroup_invocations = basic.limits.maxComputeWorkGroupInvocations;
  limits.max_workgroup_count_x = basic.limits.maxComputeWorkGroupCount[0];
  limits.max_push_constant_bytes = basic.limits.maxPushConstantsSize;
  limits.max_shared_memory_bytes = basic.limits.maxComputeSharedMemorySize;
  const auto memory = physical.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      limits.memory_bytes = std::max<std::uint64_t>(limits.memory_bytes, memory.memoryHeaps[i].size);
  if (basic.apiVersion >= VK_API_VERSION_1_1) {
    const auto chain =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties,
                                vk::PhysicalDeviceMaintenance3Properties>();
    limits.subgroup_size = chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize;
    limits.max_allocation_bytes =
        chain.get<vk::PhysicalDeviceMaintenance3Properties>().maxMemoryAllocationSize;
  }
  if (basic.apiVersion >= VK_API_VERSION_1_2) {
    const auto chain =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
    info.driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
  }
  lower(limits, limits_at_most);
  info.rejected_because = whyUnusable(physical, basic.apiVersion, limits);
  return info;
}

vk::raii::Context makeContext() {
  try {
    return vk::raii::Context();
  } catch (const std::exception&) {
    throw DeviceError(DeviceErrorCode::NoDriver,
                      "No Vulkan loader found (libvulkan.so.1); install libvulkan1 and a driver, for example "
                      "mesa-vulkan-drivers, which also runs without a GPU.");
  }
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
  // Lets the loader list MoltenVK, which conforms to a portability subset of Vulkan.
  vk::InstanceCreateFlags flags;
  for (const auto& extension : context.enumerateInstanceExtensionProperties())
    if (std::strcmp(extension.extensionName, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME) == 0) {
      extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
      flags |= vk::InstanceCreateFlagBits::eEnumeratePortabilityKHR;
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
                    "No Vulkan device fits; choose another with --device." + reasons);
}

vk::raii::Device makeDevice(const vk::raii::PhysicalDevice& physical, std::uint32_t family) {
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue({}, family, 1, &priority);
  std::vector<const char*> extensions;
  for (const auto& extension : physical.enumerateDeviceExtensionProperties())
    if (std::strcmp(extension.extensionName, "VK_KHR_portability_subset") ==
        0)  // must be enabled where present
      extensions.push_back("VK_KHR_portability_subset");
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
  const auto context = makeContext();
  const auto instance = makeInstance(context, false);
  std::vector<DeviceInfo> devices;
  for (const auto& physical : physicalDevices(instance))
    devices.push_back(describe(physical, static_cast<int>(devices.size()), limits_at_most));
  return devices;
}

Device::Device(const DeviceOptions& options) : impl_(new Impl{makeContext()}) {
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
  d.memory = d.physical.getMemoryProperties();
  const auto family = static_cast<std::uint32_t>(computeQueueFamily(d.physical));
  try {
    d.device = makeDevice(d.physical, family);
    d.queue = d.device.getQueue(family, 0);
    d.command_pool = {d.device,
                      vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eResetCommandBuffer, family)};
    d.pipeline_cache = {d.device, vk::PipelineCacheCreateInfo()};
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "opening the device " + d.info.name);
  }
}

Device::~Device() {
  if (impl_ && *impl_->device) impl_->device.waitIdle();
}
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
