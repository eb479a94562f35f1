// One shader's kernels by their specialisation constants.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "engine/kernel.h"

namespace rosefusion {

/// Owning; the Device must outlive it. One thread.
class KernelVariants {
 public:
  /// As a Kernel's.
  KernelVariants(Device& device, const ShaderCode& code, std::uint32_t bindings, std::uint32_t push_bytes)
      : device_(device), code_(code), bindings_(bindings), push_bytes_(push_bytes) {}

  /// Made when it is first asked for, which takes a driver 10 to 1000 ms. Specialisation constant 0 of
  /// kernels that read a volume is VolumeView::chunks().
  template <typename... Constants>
  const Kernel& of(Constants... constants) {
    const std::vector<std::uint32_t> values{static_cast<std::uint32_t>(constants)...};
    Kernel& kernel = kernels_[values];
    if (!kernel) kernel = Kernel(device_, code_, bindings_, push_bytes_, values);
    return kernel;
  }

 private:
  Device& device_;
  ShaderCode code_;
  std::uint32_t bindings_, push_bytes_;
  std::map<std::vector<std::uint32_t>, Kernel> kernels_;
};

}  // namespace rosefusion
