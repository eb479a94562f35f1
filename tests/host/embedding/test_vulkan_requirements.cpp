// What an application's Vulkan device must have, told before anything is made on it.
#include <cstring>
#include <utility>

#include "rosefusion/vulkan.h"
#include "tests/engine/validating_device.h"
#include "tests/host/embedding/caller_handles.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_vulkan_requirements {

class VulkanRequired : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_THAT(caller.messages(), ::testing::IsEmpty()); }
  VulkanHandles handles() const { return handlesOf(caller); }
  Caller caller;
};

// A device with fewer storage buffers for a shader than the volume needs.
struct Poor {
  static inline PFN_vkGetInstanceProcAddr get;
  static inline PFN_vkGetPhysicalDeviceProperties properties;
  static void VKAPI_CALL poorProperties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* out) {
    properties(physical, out);
    out->limits.maxPerStageDescriptorStorageBuffers = 7;
  }
  static PFN_vkVoidFunction VKAPI_CALL proc(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction real = get(instance, name);
    if (std::strcmp(name, "vkGetPhysicalDeviceProperties") != 0) return real;
    properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&poorProperties);
  }
};

TEST_F(VulkanRequired, WhatTheDeviceLacksIsNamedBeforeAnyWork) {
  VulkanHandles h = handles();
  Poor::get = std::exchange(h.get_instance_proc_addr, Poor::proc);
  h.allocator = &caller.callbacks();
  try {
    Reconstructor(publicCamera(), h, quickOptions());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::MissingLimit);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("maxPerStageDescriptorStorageBuffers is 7"));
  }
  EXPECT_EQ(caller.allocations(), 0);
}

TEST_F(VulkanRequired, RequirementsAreToldBeforeThereIsADevice) {
  EXPECT_EQ(vulkanRequirements().api_version, VK_API_VERSION_1_1);
  EXPECT_STREQ(vulkanRequirements().instance_extension_where_offered,
               VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
  EXPECT_EQ(vulkanRequirements().instance_flag_with_it,
            VkInstanceCreateFlags(VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR));
  VulkanHandles undecided = handles();
  undecided.device = VK_NULL_HANDLE;
  undecided.queue = VK_NULL_HANDLE;
  EXPECT_THAT(missingFor(undecided), ::testing::IsEmpty());
  undecided.queue_family = 99;
  EXPECT_THAT(missingFor(undecided), ::testing::ElementsAre(::testing::HasSubstr("queue family 99")));
}

}  // namespace test_vulkan_requirements
}  // namespace rosefusion::testing
