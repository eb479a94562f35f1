// The bindings of a kernel on devices that bind few storage buffers: a pool of the volume takes one of them,
// not four.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/shader_code.h"

namespace rosefusion {

/// A module in which all chunks of a pool share the binding of the first, and the rest are numbered anew
/// without gaps. For volumes of one chunk, whose kernels (specialisation constant 0 is 1) use no other.
struct OnePoolModule {
  std::vector<std::uint32_t> words;
  std::vector<std::uint32_t> kept;  ///< numbers of the bindings that are left, as `code` has them
};

/// Chunks are known by the names that lib/read.glsl and lib/written_pool.glsl give their blocks: pool_0_block
/// to pool_3_block.
OnePoolModule withOnePool(const ShaderCode& code);

}  // namespace rosefusion
