// The Vulkan commands that the engine calls, as a table of its own: nothing of Vulkan is linked, and no
// symbol of it can meet an application's. Included by engine/*.cpp only.
#pragma once
#include <vulkan/vulkan_core.h>

namespace rosefusion {

// clang-format off
#define ROSEFUSION_LOADER_COMMANDS(X) \
  X(CreateInstance) X(EnumerateInstanceExtensionProperties) X(EnumerateInstanceLayerProperties) \
  X(EnumerateInstanceVersion)
#define ROSEFUSION_INSTANCE_COMMANDS(X) \
  X(CreateDebugUtilsMessengerEXT) X(CreateDevice) X(DestroyDebugUtilsMessengerEXT) X(DestroyInstance) \
  X(EnumerateDeviceExtensionProperties) X(EnumeratePhysicalDevices) X(GetDeviceProcAddr) \
  X(GetPhysicalDeviceMemoryProperties) X(GetPhysicalDeviceMemoryProperties2) X(GetPhysicalDeviceProperties) \
  X(GetPhysicalDeviceProperties2) X(GetPhysicalDeviceQueueFamilyProperties)
#define ROSEFUSION_DEVICE_COMMANDS(X) \
  X(AllocateCommandBuffers) X(AllocateDescriptorSets) X(AllocateMemory) X(BeginCommandBuffer) X(BindBufferMemory) \
  X(CmdBindDescriptorSets) X(CmdBindPipeline) X(CmdCopyBuffer) X(CmdCopyBufferToImage) X(CmdCopyImageToBuffer) \
  X(CmdDispatch) X(CmdFillBuffer) X(CmdPipelineBarrier) X(CmdPushConstants) X(CreateBuffer) X(CreateBufferView) \
  X(CreateCommandPool) X(CreateComputePipelines) X(CreateDescriptorPool) X(CreateDescriptorSetLayout) X(CreateFence) \
  X(CreatePipelineCache) X(CreatePipelineLayout) X(CreateShaderModule) X(DestroyBuffer) X(DestroyBufferView) \
  X(DestroyCommandPool) X(DestroyDescriptorPool) X(DestroyDescriptorSetLayout) X(DestroyDevice) X(DestroyFence) \
  X(DestroyPipeline) X(DestroyPipelineCache) X(DestroyPipelineLayout) X(DestroyShaderModule) X(EndCommandBuffer) \
  X(FreeMemory) X(GetBufferMemoryRequirements) X(GetDeviceQueue) X(GetFenceStatus) X(InvalidateMappedMemoryRanges) \
  X(MapMemory) X(QueueSubmit) X(ResetCommandBuffer) X(ResetDescriptorPool) X(ResetFences) X(UpdateDescriptorSets) \
  X(WaitForFences)
// clang-format on

/// Named as in Vulkan, without the vk. A command that the loader, the instance or the device does not know is
/// null.
struct Commands {
  explicit Commands(PFN_vkGetInstanceProcAddr get) : GetInstanceProcAddr(get) {
#define ROSEFUSION_LOAD(name) load(name, get(nullptr, "vk" #name));
    ROSEFUSION_LOADER_COMMANDS(ROSEFUSION_LOAD)
#undef ROSEFUSION_LOAD
  }
  void loadFor(VkInstance instance) {
#define ROSEFUSION_LOAD(name) load(name, GetInstanceProcAddr(instance, "vk" #name));
    ROSEFUSION_INSTANCE_COMMANDS(ROSEFUSION_LOAD)
#undef ROSEFUSION_LOAD
  }
  void loadFor(VkDevice device) {
#define ROSEFUSION_LOAD(name) load(name, GetDeviceProcAddr(device, "vk" #name));
    ROSEFUSION_DEVICE_COMMANDS(ROSEFUSION_LOAD)
#undef ROSEFUSION_LOAD
  }

  PFN_vkGetInstanceProcAddr GetInstanceProcAddr;
#define ROSEFUSION_DECLARE(name) PFN_vk##name name = nullptr;
  ROSEFUSION_LOADER_COMMANDS(ROSEFUSION_DECLARE)
  ROSEFUSION_INSTANCE_COMMANDS(ROSEFUSION_DECLARE)
  ROSEFUSION_DEVICE_COMMANDS(ROSEFUSION_DECLARE)
#undef ROSEFUSION_DECLARE

 private:
  template <typename Command>
  static void load(Command& command, PFN_vkVoidFunction found) {
    command = reinterpret_cast<Command>(found);
  }
};

}  // namespace rosefusion
