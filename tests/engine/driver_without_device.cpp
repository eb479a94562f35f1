// A Vulkan driver that finds no device, as a GPU's driver does on a machine without the GPU: for
// test_device.cpp.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstring>

namespace {

// A dispatchable handle begins with a word that belongs to the loader, marked thus (loader interface, "ICD
// dispatchable handles").
std::uintptr_t instance_storage[2] = {0x01CDC0DE, 0};

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo*, const VkAllocationCallbacks*,
                                              VkInstance* instance) {
  *instance = reinterpret_cast<VkInstance>(instance_storage);
  return VK_SUCCESS;
}
VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance, const VkAllocationCallbacks*) {}
VKAPI_ATTR VkResult VKAPI_CALL nothing(const char*, std::uint32_t* count, void*) {
  *count = 0;
  return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL noDevices(VkInstance, std::uint32_t* count, VkPhysicalDevice*) {
  *count = 0;
  return VK_SUCCESS;
}
// The loader asks for every command of Vulkan 1.0 and calls none of the rest for want of a device.
VKAPI_ATTR void VKAPI_CALL neverCalled() {}

}  // namespace

extern "C" {

VkResult vk_icdNegotiateLoaderICDInterfaceVersion(std::uint32_t* version) {
  *version = 5;
  return VK_SUCCESS;
}

PFN_vkVoidFunction vk_icdGetInstanceProcAddr(VkInstance, const char* name) {
  const auto is = [&](const char* command) { return std::strcmp(name, command) == 0; };
  if (is("vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (is("vkDestroyInstance")) return reinterpret_cast<PFN_vkVoidFunction>(destroyInstance);
  if (is("vkEnumerateInstanceExtensionProperties")) return reinterpret_cast<PFN_vkVoidFunction>(nothing);
  if (is("vkEnumeratePhysicalDevices")) return reinterpret_cast<PFN_vkVoidFunction>(noDevices);
  if (is("vkEnumeratePhysicalDeviceGroups") || is("vkEnumerateInstanceVersion")) return nullptr;
  return reinterpret_cast<PFN_vkVoidFunction>(neverCalled);
}

}  // extern "C"
