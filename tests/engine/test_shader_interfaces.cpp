// What the shaders ask of a device. That C++ and GLSL lay shared structs out alike is asserted by the build.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/caller_device.h"
#include "engine/pool_bindings.h"
#include "engine/reflection.h"

namespace rosefusion::testing {
namespace test_shader_interfaces {

TEST(ShaderInterfaces, PushConstantsFitEveryDevice) {
  for (const ShaderCode& code : allShaders()) EXPECT_LE(reflect(code).push.bytes, 128u) << code.name;
}

/// What Vulkan requires of every device: maxPerStageDescriptorSampledImages, which texel buffers count as,
/// and maxPerStageDescriptorUniformBuffers. Of storage buffers it requires only 4: a device is asked for
/// those there is need of when a pool is one buffer, and all four are bound from so many on as they need.
TEST(ShaderInterfaces, BindingsFitEveryDeviceThatIsAccepted) {
  std::uint32_t most_storage = 0, most_of_one_pool = 0;
  for (const ShaderCode& code : allShaders()) {
    std::map<BindingKind, int> count;
    const ShaderInterface shader = reflect(code);
    for (const ShaderBinding& binding : shader.bindings) ++count[binding.kind];
    EXPECT_LE(count[BindingKind::WordTexels] + count[BindingKind::VectorTexels], 16) << code.name;
    EXPECT_LE(count[BindingKind::Uniform], 12) << code.name;
    most_storage = std::max(most_storage, static_cast<std::uint32_t>(count[BindingKind::Storage]));
    std::uint32_t storage = 0;
    for (const std::uint32_t i : withOnePool(code).kept)
      storage += shader.bindings[i].kind == BindingKind::Storage ? 1 : 0;
    most_of_one_pool = std::max(most_of_one_pool, storage);
  }
  DeviceInfo device;
  device.limits.max_storage_buffers = most_storage;
  EXPECT_TRUE(device.bindsAllChunks());
  --device.limits.max_storage_buffers;
  EXPECT_FALSE(device.bindsAllChunks());
  EXPECT_EQ(deviceRequirements().limits.max_storage_buffers, most_of_one_pool);
}

TEST(ShaderInterfaces, OnePoolLeavesNoGapsInTheBindings) {
  const ShaderCode code = shaderCode("refine");
  const OnePoolModule one = withOnePool(code);
  // Of the pools on 2 to 5 and 10 to 13 the first buffers stay.
  EXPECT_EQ(one.kept, (std::vector<std::uint32_t>{0, 1, 2, 6, 7, 8, 9, 10}));
  EXPECT_EQ(one.words.size(), code.words.size());
  std::map<std::uint32_t, int> users;
  for (const ShaderBinding& binding : reflect({"refine", one.words}).bindings) ++users[binding.number];
  EXPECT_EQ(users.size(), one.kept.size());
  EXPECT_EQ(users[2], 4);
  EXPECT_EQ(users[3], 1);
  EXPECT_EQ(users[7], 4);
}

}  // namespace test_shader_interfaces
}  // namespace rosefusion::testing
