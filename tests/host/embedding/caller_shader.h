// A compute shader of an application, run on the application's device with storage buffers 0, 1, ...
#pragma once
#include <span>
#include <vector>

#include "tests/engine/caller.h"

namespace rosefusion::testing {

/// Runs `groups` workgroups of `words` (SPIR-V) with specialisation constant 0, after everything submitted
/// before, ends with the barrier that rosefusion/vulkan.h asks for, and waits.
void runShader(Caller& caller, std::span<const std::uint32_t> words, std::uint32_t constant,
               const std::vector<VkBuffer>& buffers, std::uint32_t groups);

}  // namespace rosefusion::testing
