// What the shaders ask of a device. That C++ and GLSL lay shared structs out alike is asserted by the build.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/caller_device.h"
#include "engine/reflection.h"

namespace rosefusion::testing {
namespace test_shader_interfaces {

TEST(ShaderInterfaces, PushConstantsFitEveryDevice) {
  for (const ShaderCode& code : allShaders()) EXPECT_LE(reflect(code).push.bytes, 128u) << code.name;
}

/// What Vulkan requires of every device: maxPerStageDescriptorSampledImages, which texel buffers count as,
/// and maxPerStageDescriptorUniformBuffers. Of storage buffers it requires only 4: a device is asked for
/// those there is need of.
TEST(ShaderInterfaces, BindingsFitEveryDeviceThatIsAccepted) {
  int most_storage = 0;
  for (const ShaderCode& code : allShaders()) {
    std::map<BindingKind, int> count;
    for (const ShaderBinding& binding : reflect(code).bindings) ++count[binding.kind];
    EXPECT_LE(count[BindingKind::WordTexels] + count[BindingKind::VectorTexels], 16) << code.name;
    EXPECT_LE(count[BindingKind::Uniform], 12) << code.name;
    most_storage = std::max(most_storage, count[BindingKind::Storage]);
  }
  EXPECT_EQ(deviceRequirements().limits.max_storage_buffers, static_cast<std::uint32_t>(most_storage));
}

}  // namespace test_shader_interfaces
}  // namespace rosefusion::testing
