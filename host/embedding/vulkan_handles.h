// The public Vulkan structs as the engine's.
#pragma once
#include "engine/caller_device.h"
#include "rosefusion/vulkan.h"

namespace rosefusion {

CallerDevice toCallerDevice(const VulkanHandles& handles);
std::vector<SemaphorePoint> toPoints(const std::vector<Semaphores::Point>& points);

}  // namespace rosefusion
