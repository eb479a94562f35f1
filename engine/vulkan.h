// Vulkan-Hpp RAII and the Device's insides; included by engine/*.cpp only.
#pragma once
#include <vulkan/vulkan_raii.hpp>

#include "engine/device.h"

namespace rosefusion {

struct Device::Impl {
  vk::raii::Context context;
  std::vector<std::string> validation_messages;  // before the messenger that writes to it
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  vk::raii::CommandPool command_pool = nullptr;
  vk::raii::PipelineCache pipeline_cache = nullptr;
  vk::PhysicalDeviceMemoryProperties memory;
  DeviceInfo info;
  std::uint64_t allocated_bytes = 0;
};

/// Turns a Vulkan failure into a DeviceError; `doing` completes "... failed while <doing>".
[[noreturn]] void throwDeviceError(const vk::SystemError& error, const std::string& doing);

}  // namespace rosefusion
