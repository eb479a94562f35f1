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

struct ShaderInterface {
  std::vector<std::uint32_t> storage_bindings;  ///< of set 0, ascending
  std::string push_type;         ///< name of the push-constant struct; empty when there is none
  std::uint32_t push_bytes = 0;  ///< declared size
  std::vector<ShaderMember> push_members;
  std::array<std::uint32_t, 3> workgroup{1, 1, 1};
};

/// Throws DeviceError (Programming) for a module SPIRV-Cross cannot parse.
ShaderInterface reflect(const ShaderCode& code);

}  // namespace rosefusion
