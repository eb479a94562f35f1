// A Vulkan layer that lets one call of a command fail, as a full or a lost device would. FAULT_COMMAND
// (vkAllocateMemory), FAULT_CALL (the how manieth, from 1 on) and FAULT_RESULT (the VkResult's number) say
// which; FAULT_COUNTS names a file that the numbers of calls are written to when a device goes.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace {

// clang-format off
#define INSTANCE_COMMANDS(X) X(EnumeratePhysicalDevices)
#define DEVICE_COMMANDS(X) \
  X(AllocateCommandBuffers) X(AllocateDescriptorSets) X(AllocateMemory) X(BeginCommandBuffer) X(BindBufferMemory) \
  X(BindImageMemory) X(CreateBuffer) X(CreateBufferView) X(CreateCommandPool) X(CreateComputePipelines) \
  X(CreateDescriptorPool) X(CreateDescriptorSetLayout) X(CreateFence) X(CreateFramebuffer) X(CreateGraphicsPipelines) \
  X(CreateImage) X(CreateImageView) X(CreatePipelineCache) X(CreatePipelineLayout) X(CreateRenderPass) \
  X(CreateSampler) X(CreateSemaphore) X(CreateShaderModule) X(DeviceWaitIdle) X(EndCommandBuffer) \
  X(FlushMappedMemoryRanges) X(GetFenceStatus) X(InvalidateMappedMemoryRanges) X(MapMemory) X(QueueSubmit) \
  X(QueueWaitIdle) X(ResetCommandBuffer) X(ResetFences) X(WaitForFences)
// clang-format on

enum Command {
#define NAMED(name) k##name,
  INSTANCE_COMMANDS(NAMED) DEVICE_COMMANDS(NAMED)
#undef NAMED
      kCreateInstance,
  kCreateDevice,
  kCommands
};
constexpr const char* kNames[] = {
#define NAMED(name) "vk" #name,
    INSTANCE_COMMANDS(NAMED) DEVICE_COMMANDS(NAMED)
#undef NAMED
        "vkCreateInstance",
    "vkCreateDevice"};

/// What comes after this layer, by the word that all handles of one instance or device begin with.
struct Next {
  PFN_vkGetInstanceProcAddr of_instance = nullptr;
  PFN_vkGetDeviceProcAddr of_device = nullptr;
  VkInstance instance = nullptr;
  VkDevice device = nullptr;
  PFN_vkVoidFunction commands[kCommands] = {};
};
std::mutex mutex;
std::map<const void*, Next> nexts;
std::uint64_t calls[kCommands];
std::atomic<bool> lost{false};

template <typename Handle>
const void* keyOf(Handle handle) {
  return *reinterpret_cast<void**>(handle);
}
template <typename Handle>
Next& nextOf(Handle handle) {
  const std::lock_guard lock(mutex);
  return nexts[keyOf(handle)];
}

const char* variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

struct Fault {
  std::string command;
  std::uint64_t call = 0;
  VkResult result = VK_SUCCESS;
};
Fault chosen{variable("FAULT_COMMAND"), std::strtoull(variable("FAULT_CALL"), nullptr, 10),
             static_cast<VkResult>(std::strtol(variable("FAULT_RESULT"), nullptr, 10))};

/// What this call is to return; VK_SUCCESS: what it returns by itself.
VkResult faultOf(Command command) {
  const std::lock_guard lock(mutex);
  const std::uint64_t call = ++calls[command];
  return call == chosen.call && chosen.command == kNames[command] ? chosen.result : VK_SUCCESS;
}

/// These alone tell that a device is lost.
constexpr bool tellsLoss(Command command) {
  return command == kQueueSubmit || command == kWaitForFences || command == kGetFenceStatus ||
         command == kQueueWaitIdle || command == kDeviceWaitIdle;
}

/// A lost device runs nothing any more, and stays lost.
void lose(Next& next) {
  lost = true;
  if (next.device && next.commands[kDeviceWaitIdle])
    reinterpret_cast<PFN_vkDeviceWaitIdle>(next.commands[kDeviceWaitIdle])(next.device);
}

template <Command C, typename Function>
struct Wrapped;
template <Command C, typename Handle, typename... Rest>
struct Wrapped<C, VkResult(VKAPI_PTR*)(Handle, Rest...)> {
  static VKAPI_ATTR VkResult VKAPI_CALL call(Handle handle, Rest... rest) {
    Next& next = nextOf(handle);
    const VkResult fault = faultOf(C);
    if (fault == VK_ERROR_DEVICE_LOST) lose(next);
    if (fault != VK_SUCCESS) return fault;
    if (lost && tellsLoss(C)) return VK_ERROR_DEVICE_LOST;
    return reinterpret_cast<VkResult(VKAPI_PTR*)(Handle, Rest...)>(next.commands[C])(handle, rest...);
  }
};

template <typename Info>
auto* linkOf(const void* chain, VkStructureType type) {
  auto* info = static_cast<Info*>(const_cast<void*>(chain));
  while (info && !(info->sType == type && info->function == VK_LAYER_LINK_INFO))
    info = static_cast<Info*>(const_cast<void*>(info->pNext));
  return info;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* create,
                                              const VkAllocationCallbacks* allocator, VkInstance* instance) {
  auto* link =
      linkOf<VkLayerInstanceCreateInfo>(create->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  if (const VkResult fault = faultOf(kCreateInstance); fault != VK_SUCCESS) return fault;
  const VkResult result =
      reinterpret_cast<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"))(create, allocator, instance);
  if (result != VK_SUCCESS) return result;
  Next& next = nextOf(*instance);
  next = Next{get, nullptr, *instance, nullptr, {}};
#define LOAD(name) next.commands[k##name] = get(*instance, "vk" #name);
  INSTANCE_COMMANDS(LOAD)
#undef LOAD
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* create,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* link = linkOf<VkLayerDeviceCreateInfo>(create->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const auto [instance_get, device_get] =
      std::pair(link->u.pLayerInfo->pfnNextGetInstanceProcAddr, link->u.pLayerInfo->pfnNextGetDeviceProcAddr);
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  if (const VkResult fault = faultOf(kCreateDevice); fault != VK_SUCCESS) return fault;
  lost = false;
  const VkInstance instance = nextOf(physical).instance;
  const VkResult result = reinterpret_cast<PFN_vkCreateDevice>(instance_get(instance, "vkCreateDevice"))(
      physical, create, allocator, device);
  if (result != VK_SUCCESS) return result;
  Next& next = nextOf(*device);
  next = Next{instance_get, device_get, instance, *device, {}};
#define LOAD(name) next.commands[k##name] = device_get(*device, "vk" #name);
  DEVICE_COMMANDS(LOAD)
#undef LOAD
  return result;
}

void writeCounts() {
  std::FILE* out = *variable("FAULT_COUNTS") ? std::fopen(variable("FAULT_COUNTS"), "w") : nullptr;
  if (!out) return;
  for (int c = 0; c < kCommands; ++c)
    if (calls[c] > 0) std::fprintf(out, "%s %llu\n", kNames[c], static_cast<unsigned long long>(calls[c]));
  std::fclose(out);
}

VKAPI_ATTR void VKAPI_CALL destroyDevice(VkDevice device, const VkAllocationCallbacks* allocator) {
  const Next next = nextOf(device);
  reinterpret_cast<PFN_vkDestroyDevice>(next.of_device(device, "vkDestroyDevice"))(device, allocator);
  writeCounts();
}

PFN_vkVoidFunction wrapped(const char* name) {
#define WRAPPED(command)                     \
  if (std::strcmp(name, "vk" #command) == 0) \
    return reinterpret_cast<PFN_vkVoidFunction>(Wrapped<k##command, PFN_vk##command>::call);
  INSTANCE_COMMANDS(WRAPPED)
  DEVICE_COMMANDS(WRAPPED)
#undef WRAPPED
  if (std::strcmp(name, "vkDestroyDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(destroyDevice);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(getDeviceProcAddr);
  const PFN_vkVoidFunction own = wrapped(name);
  const PFN_vkVoidFunction theirs = nextOf(device).of_device(device, name);
  return own && theirs ? own : theirs;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name) {
  const auto is = [&](const char* command) { return std::strcmp(name, command) == 0; };
  if (is("vkGetInstanceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(getInstanceProcAddr);
  if (is("vkGetDeviceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(getDeviceProcAddr);
  if (is("vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (is("vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(createDevice);
  if (const PFN_vkVoidFunction own = wrapped(name)) return own;
  return instance ? nextOf(instance).of_instance(instance, name) : nullptr;
}

}  // namespace

extern "C" {

/// For a test in the same process: lets the `call`-th call from now on fail.
void failCall(const char* command, std::uint64_t call, int result) {
  const std::lock_guard lock(mutex);
  for (int c = 0; c < kCommands; ++c)
    if (std::strcmp(command, kNames[c]) == 0)
      chosen = {command, calls[c] + call, static_cast<VkResult>(result)};
}

std::uint64_t callsOf(const char* command) {
  const std::lock_guard lock(mutex);
  for (int c = 0; c < kCommands; ++c)
    if (std::strcmp(command, kNames[c]) == 0) return calls[c];
  return 0;
}

VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* layer) {
  layer->loaderLayerInterfaceVersion = 2;
  layer->pfnGetInstanceProcAddr = getInstanceProcAddr;
  layer->pfnGetDeviceProcAddr = getDeviceProcAddr;
  layer->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}

}  // extern "C"
