// Vulkan-Hpp RAII and the Device's insides; included by engine/*.cpp only.
#pragma once
#include <vulkan/vulkan_raii.hpp>

#include <atomic>
#include <functional>
#include <mutex>

#include "engine/device.h"

namespace rosefusion {

struct Device::Impl {
  explicit Impl(PFN_vkGetInstanceProcAddr get_instance_proc_addr) : context(get_instance_proc_addr) {}
  /// Makes what the engine needs on `device` of `family`; the rest of the handles are there already.
  void open(std::uint32_t family, vk::Queue caller_queue);
  /// From any thread. Throws vk::SystemError.
  void submit(const vk::SubmitInfo& work, vk::Fence fence);

  std::shared_ptr<void> loader;  // keeps the library that the context calls
  vk::raii::Context context;
  std::vector<std::string> validation_messages;  // before the messenger that writes to it
  vk::AllocationCallbacks allocation_callbacks;
  const vk::AllocationCallbacks* allocator = nullptr;  // for everything that is made here
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  std::uint32_t queue_family = 0;
  std::mutex queue_mutex;
  std::function<void()> lock_queue, unlock_queue;  // the caller's, around ours
  vk::raii::PipelineCache own_pipeline_cache = nullptr;
  vk::PipelineCache pipeline_cache;
  vk::PhysicalDeviceMemoryProperties memory;
  DeviceInfo info;
  std::atomic<std::uint64_t> allocated_bytes = 0;
};

/// Turns a Vulkan failure into a DeviceError; `doing` completes "... failed while <doing>".
[[noreturn]] void throwDeviceError(const vk::SystemError& error, const std::string& doing);

}  // namespace rosefusion
