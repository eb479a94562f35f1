// The compiled shaders, embedded in the library by shaders/compute/CMakeLists.txt.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace rosefusion {

/// SPIR-V of one compute shader; `name` is the stem of its .comp file.
struct ShaderCode {
  std::string_view name;
  std::span<const std::uint32_t> words;
};

/// Throws DeviceError (Programming) for a name that is not embedded.
ShaderCode shaderCode(std::string_view name);

/// Every embedded shader, in alphabetical order.
std::span<const ShaderCode> allShaders();

}  // namespace rosefusion
