// What a SPIR-V module says of itself, read with SPIRV-Cross.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/shader_code.h"

namespace rosefusion {

struct ShaderMember {
  std::string name;
  std::uint32_t offset_bytes = 0;
};

/// A struct as the shader lays it out; `bytes` reaches to the end of its last member.
struct ShaderStruct {
  std::string name;
  std::uint32_t bytes = 0;
  std::vector<ShaderMember> members;
};

enum class BindingKind { Storage, Uniform, WordTexels, VectorTexels };

struct ShaderBinding {
  std::uint32_t number = 0;
  BindingKind kind = BindingKind::Storage;
};

struct ShaderInterface {
  std::vector<ShaderBinding> bindings;  ///< of set 0, by ascending number
  ShaderStruct push;                    ///< push constants; no name and no bytes when there are none
  std::vector<ShaderStruct> structs;    ///< directly inside storage and uniform buffers, each type once
  std::array<std::uint32_t, 3> workgroup{1, 1, 1};
};

/// Throws DeviceError (Programming) for a module SPIRV-Cross cannot parse.
ShaderInterface reflect(const ShaderCode& code);

}  // namespace rosefusion
