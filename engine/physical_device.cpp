#include "engine/physical_device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "engine/error.h"
#include "engine/memory_types.h"

namespace rosefusion {
namespace {

constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";
constexpr int kMesaDozen =
    23;  // VK_DRIVER_ID_MESA_DOZEN, since headers 1.3.226: Vulkan on Direct3D 12, as in WSL

DeviceType typeOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::Discrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::Integrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::Virtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::Cpu;
    default:
      return DeviceType::Other;
  }
}

/// Lowers what `limits` says to what `at_most` says, where that is not 0.
void lower(DeviceLimits& limits, const DeviceLimits& at_most) {
  const auto apply = [](auto& value, auto most) { value = most ? std::min(value, most) : value; };
  apply(limits.max_storage_buffer_bytes, at_most.max_storage_buffer_bytes);
  apply(limits.max_storage_buffers, at_most.max_storage_buffers);
  apply(limits.max_texels, at_most.max_texels);
  apply(limits.max_workgroup_invocations, at_most.max_workgroup_invocations);
  apply(limits.max_workgroup_count_x, at_most.max_workgroup_count_x);
  apply(limits.max_push_constant_bytes, at_most.max_push_constant_bytes);
  apply(limits.max_shared_memory_bytes, at_most.max_shared_memory_bytes);
  apply(limits.memory_bytes, at_most.memory_bytes);
  apply(limits.max_allocation_bytes, at_most.max_allocation_bytes);
}

bool offers(const Commands& vk, VkPhysicalDevice physical, const char* extension) {
  const auto all = enumerate<VkExtensionProperties>(vk.EnumerateDeviceExtensionProperties, physical, nullptr);
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, extension) == 0; });
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

/// Less is better: what a driver says that it does not do as Vulkan asks comes after all the rest.
std::pair<bool, DeviceType> rank(const DeviceInfo& info) {
  return {!info.conformant, info.type};
}

}  // namespace

DeviceRequirements deviceRequirements() {
  DeviceRequirements needs;
  needs.extensions_where_offered = {kPortabilitySubset};
  // Every desktop and mobile driver known to us has more (spec minima in brackets).
  needs.limits.max_storage_buffers = 8;                // [4]; DeviceInfo::bindsAllChunks from 16 on
  needs.limits.max_workgroup_invocations = 128;        // [128]
  needs.limits.max_push_constant_bytes = 128;          // [128]
  needs.limits.max_shared_memory_bytes = 16384;        // [16384]
  needs.limits.max_storage_buffer_bytes = 128u << 20;  // [2^27]
  return needs;
}

std::string versionText(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) +
         "." + std::to_string(VK_API_VERSION_PATCH(version));
}

std::string joined(std::span<const std::string> clauses) {
  std::string text;
  for (const std::string& clause : clauses) text += (text.empty() ? "" : "; ") + clause;
  return text;
}

std::vector<VkQueueFamilyProperties> queueFamilies(const Commands& vk, VkPhysicalDevice physical) {
  return enumerate<VkQueueFamilyProperties>(vk.GetPhysicalDeviceQueueFamilyProperties, physical);
}

int computeQueueFamily(const Commands& vk, VkPhysicalDevice physical) {
  const VkQueueFlags needed = deviceRequirements().queue_flags;
  const auto families = queueFamilies(vk, physical);
  for (std::size_t i = 0; i < families.size(); ++i)
    if ((families[i].queueFlags & needed) == needed) return static_cast<int>(i);
  return -1;
}

std::vector<const char*> extensionsToEnable(const Commands& vk, VkPhysicalDevice physical) {
  std::vector<const char*> names = deviceRequirements().extensions_where_offered;
  std::erase_if(names, [&](const char* name) { return !offers(vk, physical, name); });
  return names;
}

std::vector<std::string> missingOf(const Commands& vk, VkPhysicalDevice physical, const DeviceLimits& has) {
  const DeviceRequirements needs = deviceRequirements();
  VkPhysicalDeviceProperties basic;
  vk.GetPhysicalDeviceProperties(physical, &basic);
  const std::uint32_t version = basic.apiVersion;
  std::vector<std::string> missing;
  if (version < needs.api_version)
    missing.push_back("it offers Vulkan " + versionText(version) + ", rosefusion needs " +
                      versionText(needs.api_version) +
                      ", which a newer driver may offer (for many GPUs the package mesa-vulkan-drivers)");
  if (computeQueueFamily(vk, physical) < 0) missing.push_back("it has no compute queue");
  const auto compare = [&](const char* what, std::uint64_t have, std::uint64_t need) {
    if (have < need)
      missing.push_back(std::string(what) + " is " + std::to_string(have) + ", rosefusion needs " +
                        std::to_string(need));
  };
  compare("maxPerStageDescriptorStorageBuffers", has.max_storage_buffers, needs.limits.max_storage_buffers);
  compare("maxComputeWorkGroupInvocations", has.max_workgroup_invocations,
          needs.limits.max_workgroup_invocations);
  compare("maxPushConstantsSize", has.max_push_constant_bytes, needs.limits.max_push_constant_bytes);
  compare("maxComputeSharedMemorySize", has.max_shared_memory_bytes, needs.limits.max_shared_memory_bytes);
  compare("maxStorageBufferRange", has.max_storage_buffer_bytes, needs.limits.max_storage_buffer_bytes);
  return missing;
}

DeviceInfo describe(const Commands& vk, VkPhysicalDevice physical, int index,
                    const DeviceLimits& limits_at_most) {
  DeviceInfo info;
  info.index = index;
  VkPhysicalDeviceProperties basic;
  vk.GetPhysicalDeviceProperties(physical, &basic);
  info.name = basic.deviceName;
  info.type = typeOf(basic.deviceType);
  info.api_version = versionText(basic.apiVersion);
  info.driver = "version " + std::to_string(basic.driverVersion);
  DeviceLimits& limits = info.limits;
  limits.max_storage_buffer_bytes = basic.limits.maxStorageBufferRange;
  limits.max_storage_buffers =
      std::min(basic.limits.maxPerStageDescriptorStorageBuffers, basic.limits.maxDescriptorSetStorageBuffers);
  limits.max_texels = basic.limits.maxTexelBufferElements;
  limits.max_workgroup_invocations = basic.limits.maxComputeWorkGroupInvocations;
  limits.max_workgroup_count_x = basic.limits.maxComputeWorkGroupCount[0];
  limits.max_push_constant_bytes = basic.limits.maxPushConstantsSize;
  limits.max_shared_memory_bytes = basic.limits.maxComputeSharedMemorySize;
  VkPhysicalDeviceMemoryProperties memory;
  vk.GetPhysicalDeviceMemoryProperties(physical, &memory);
  if (basic.apiVersion >= VK_API_VERSION_1_1) {
    // Devices of 1.1 do not know the last struct.
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    const bool names_driver = basic.apiVersion >= VK_API_VERSION_1_2;
    VkPhysicalDeviceMaintenance3Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
                                                 names_driver ? &driver : nullptr};
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
                                                &sizes};
    VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup};
    vk.GetPhysicalDeviceProperties2(physical, &all);
    limits.subgroup_size = subgroup.subgroupSize;
    limits.max_allocation_bytes = sizes.maxMemoryAllocationSize;
    if (names_driver) {
      info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
      info.conformant = driver.driverID != VK_DRIVER_ID_MESA_DOZEN && driver.conformanceVersion.major > 0;
    }
  }
  VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
  const bool has_budget =
      basic.apiVersion >= VK_API_VERSION_1_1 && offers(vk, physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  if (has_budget) {
    VkPhysicalDeviceMemoryProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2, &budget};
    vk.GetPhysicalDeviceMemoryProperties2(physical, &all);
  }
  limits.memory_bytes = usableBytes(memory, has_budget ? budget.heapBudget : nullptr, info.type);
  lower(limits, limits_at_most);
  info.rejected_because = joined(missingOf(vk, physical, limits));
  return info;
}

std::size_t chooseDevice(const std::vector<DeviceInfo>& devices, const std::string& select) {
  std::size_t best = devices.size();
  std::string reasons;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& info = devices[i];
    const bool wanted = matches(info, select);
    if (wanted && info.rejected_because.empty()) {
      if (best == devices.size() || rank(info) < rank(devices[best])) best = i;
      continue;
    }
    reasons += " [" + std::to_string(info.index) + "] " + info.name + ": " +
               (wanted ? info.rejected_because : "is not '" + select + "'") + ".";
  }
  if (best < devices.size()) return best;
  throw DeviceError(DeviceErrorCode::NoDevice,
                    "No Vulkan device fits; choose another with --device or $ROSEFUSION_DEVICE." + reasons);
}

}  // namespace rosefusion
