// The one exception type of the engine.
#pragma once
#include <stdexcept>
#include <string>

namespace rosefusion {

enum class DeviceErrorCode {
  NoDriver,      ///< no Vulkan loader or no driver installed
  NoDevice,      ///< no device, or none that meets the selection and the limits
  MissingLimit,  ///< the device cannot run this pass or this size
  OutOfMemory,   ///< device memory, or the limit set for the volume, is reached
  DeviceLost,    ///< the driver gave up on the device
  Programming,   ///< this program misused the engine: a defect
};

/// Programming and device failures. what() is one sentence that says what to do.
class DeviceError : public std::runtime_error {
 public:
  DeviceError(DeviceErrorCode code, const std::string& sentence)
      : std::runtime_error(sentence), code_(code) {}
  DeviceErrorCode code() const { return code_; }

 private:
  DeviceErrorCode code_;
};

/// Whether a VkResult says that memory is exhausted, the host's or the device's, or what else a driver keeps
/// a limited number of.
bool isOutOfMemory(int vk_result);

}  // namespace rosefusion
