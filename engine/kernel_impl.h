// The Kernel's insides; included by engine/*.cpp only.
#pragma once
#include <string>

#include "engine/kernel.h"
#include "engine/reflection.h"
#include "engine/vulkan.h"

namespace rosefusion {

VkDescriptorType descriptorType(BindingKind kind);

struct Kernel::Impl {
  std::string name;
  std::vector<BindingKind> kinds;   // of the bindings 0, 1, ...
  std::uint32_t given = 0;          // buffers that a dispatch gives
  std::vector<std::uint32_t> kept;  // those of them that are bound, in the bindings' order
  std::uint32_t push_bytes = 0;
  std::array<std::uint32_t, 3> workgroup{1, 1, 1};
  OwnedSetLayout set_layout;
  OwnedPipelineLayout pipeline_layout;
  OwnedPipeline pipeline;
};

}  // namespace rosefusion
