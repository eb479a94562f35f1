// An application's Vulkan handles as the public headers take them.
#pragma once
#include "rosefusion/vulkan.h"
#include "tests/engine/caller.h"

namespace rosefusion::testing {

inline VulkanHandles handlesOf(const Caller& caller) {
  const CallerDevice h = caller.handles();
  return {.get_instance_proc_addr = h.get_instance_proc_addr,
          .instance = h.instance,
          .physical_device = h.physical_device,
          .device = h.device,
          .queue = h.queue};
}

}  // namespace rosefusion::testing
