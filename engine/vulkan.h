// The Device's insides; included by engine/*.cpp only.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>

#include "engine/device.h"
#include "engine/owned.h"

namespace rosefusion {

struct Device::Impl : Maker {
  explicit Impl(PFN_vkGetInstanceProcAddr get_instance_proc_addr) : Maker{Commands(get_instance_proc_addr)} {}
  Impl(const Impl&) = delete;
  ~Impl();
  /// Makes what the engine needs on `device`, whose commands are loaded here. Throws DeviceError.
  void open(std::uint32_t family, VkQueue callers_queue, std::string_view doing);
  /// From any thread.
  [[nodiscard]] VkResult submit(const VkSubmitInfo& work, VkFence fence);

  std::shared_ptr<void> loader;  // keeps the library that the commands are in
  bool owns_handles = false;     // instance, messenger and device; else they are the caller's
  VkAllocationCallbacks allocation_callbacks{};
  VkInstance instance = nullptr;
  VkDebugUtilsMessengerEXT messenger = nullptr;
  std::vector<std::string> validation_messages;
  VkPhysicalDevice physical = nullptr;
  VkQueue queue = nullptr;
  std::uint32_t queue_family = 0;
  std::mutex queue_mutex;
  std::function<void()> lock_queue, unlock_queue;  // the caller's, around ours
  OwnedPipelineCache own_pipeline_cache;
  VkPhysicalDeviceMemoryProperties memory{};
  DeviceInfo info;
  std::atomic<std::uint64_t> allocated_bytes = 0;
  struct {
    std::atomic<std::uint64_t> submits = 0, dispatches = 0, copied_bytes = 0;
  } work;
};

}  // namespace rosefusion
