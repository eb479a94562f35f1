// A compute pipeline, checked against its SPIR-V when it is made.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/device.h"
#include "engine/shader_code.h"

namespace rosefusion {

/// The variant of a shader that suits the device: NAME_texels, which reads through texel buffers (see
/// lib/read.glsl), where DeviceInfo::readsTexels, else NAME.
ShaderCode readerCode(const Device& device, std::string_view name);

/// Owning and movable; must not outlive its Device.
class Kernel {
 public:
  Kernel();
  /// `bindings`: buffers 0 .. bindings-1 of set 0, of whatever kind the shader declares. `constants`: values
  /// of specialisation constants 0, 1, ... Throws DeviceError (Programming) when bindings or push size are
  /// not what the shader declares, and (MissingLimit) when the workgroup is larger than the device runs.
  Kernel(Device& device, const ShaderCode& code, std::uint32_t bindings, std::uint32_t push_bytes,
         const std::vector<std::uint32_t>& constants = {});
  ~Kernel();
  Kernel(Kernel&&) noexcept;
  Kernel& operator=(Kernel&&) noexcept;
  explicit operator bool() const { return impl_ != nullptr; }

  struct Impl;
  Impl& impl() const { return *impl_; }
  /// For who keeps it alive while it runs.
  std::shared_ptr<Impl> shared() const { return impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace rosefusion
