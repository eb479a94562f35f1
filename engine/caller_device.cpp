#include "engine/caller_device.h"

#include <algorithm>

#include "engine/error.h"
#include "engine/physical_device.h"
#include "engine/vulkan.h"

namespace rosefusion {
namespace {

void requireHandles(bool all_there) {
  if (!all_there)
    throw DeviceError(DeviceErrorCode::Programming,
                      "A caller's Vulkan device was handed over incompletely; get_instance_proc_addr, "
                      "instance, physical_device, device and queue must not be null.");
}

/// Its instance and physical device, borrowed.
std::unique_ptr<Device::Impl> borrow(const CallerDevice& caller) {
  requireHandles(caller.get_instance_proc_addr && caller.instance && caller.physical_device);
  auto impl = std::make_unique<Device::Impl>(caller.get_instance_proc_addr);
  impl->instance = caller.instance;
  impl->physical = caller.physical_device;
  impl->vk.loadFor(caller.instance);
  return impl;
}

/// Also fills in what `impl` says of the device.
std::vector<std::string> missingOf(const CallerDevice& caller, Device::Impl& impl) {
  // An older instance has not the commands that the rest is asked with.
  if (const std::uint32_t needed = deviceRequirements().api_version; caller.api_version < needed)
    return {"its instance was made for Vulkan " + versionText(caller.api_version) + ", rosefusion needs " +
            versionText(needed)};
  impl.info = describe(impl.vk, impl.physical, -1, {});
  std::vector<std::string> missing = missingOf(impl.vk, impl.physical, impl.info.limits);
  const auto families = queueFamilies(impl.vk, impl.physical);
  const VkQueueFlags needed = deviceRequirements().queue_flags;
  if (caller.queue_family >= families.size())
    missing.push_back("it has no queue family " + std::to_string(caller.queue_family));
  else if ((families[caller.queue_family].queueFlags & needed) != needed)
    missing.push_back("queue family " + std::to_string(caller.queue_family) + " has no compute");
  return missing;
}

}  // namespace

std::vector<std::string> missingOf(const CallerDevice& caller) {
  return missingOf(caller, *borrow(caller));
}

Device::Device(const CallerDevice& caller) : impl_(borrow(caller)) {
  requireHandles(caller.device && caller.queue);
  Impl& d = *impl_;
  if (const auto missing = missingOf(caller, d); !missing.empty())
    throw DeviceError(DeviceErrorCode::MissingLimit, "This Vulkan device cannot run rosefusion: " +
                                                         joined(missing) + "; hand over another one.");
  if (caller.allocator) {
    d.allocation_callbacks = *caller.allocator;
    d.allocator = &d.allocation_callbacks;
  }
  d.device = caller.device;
  d.lock_queue = caller.lock_queue;
  d.unlock_queue = caller.unlock_queue;
  d.pipeline_cache = caller.pipeline_cache;
  d.open(caller.queue_family, caller.queue, "using the device " + d.info.name);
}

void submitSemaphores(Device& device, const std::vector<SemaphorePoint>& wait,
                      const std::vector<SemaphorePoint>& signal) {
  if (wait.empty() && signal.empty()) return;
  std::vector<VkSemaphore> waits, signals;
  std::vector<std::uint64_t> wait_values, signal_values;
  for (const SemaphorePoint& p : wait) waits.push_back(p.semaphore), wait_values.push_back(p.value);
  for (const SemaphorePoint& p : signal) signals.push_back(p.semaphore), signal_values.push_back(p.value);
  const std::vector<VkPipelineStageFlags> stages(waits.size(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  const auto waiting = static_cast<std::uint32_t>(waits.size());
  const auto signalling = static_cast<std::uint32_t>(signals.size());
  const VkTimelineSemaphoreSubmitInfo values{.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
                                             .waitSemaphoreValueCount = waiting,
                                             .pWaitSemaphoreValues = wait_values.data(),
                                             .signalSemaphoreValueCount = signalling,
                                             .pSignalSemaphoreValues = signal_values.data()};
  const auto isTimeline = [](std::uint64_t value) { return value != 0; };
  // Devices without timeline semaphores do not know the struct.
  const bool any =
      std::ranges::any_of(wait_values, isTimeline) || std::ranges::any_of(signal_values, isTimeline);
  const VkSubmitInfo work{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                          .pNext = any ? &values : nullptr,
                          .waitSemaphoreCount = waiting,
                          .pWaitSemaphores = waits.data(),
                          .pWaitDstStageMask = stages.data(),
                          .signalSemaphoreCount = signalling,
                          .pSignalSemaphores = signals.data()};
  require(device.impl().submit(work, nullptr), "submitting semaphores");
}

}  // namespace rosefusion
