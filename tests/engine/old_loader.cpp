// A Vulkan loader of version 1.0, which knows no vkEnumerateInstanceVersion, and nothing else: for
// test_device.cpp.
extern "C" __attribute__((visibility("default"))) void* vkGetInstanceProcAddr(void*, const char*) {
  return nullptr;
}
