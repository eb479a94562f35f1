// That the Vulkan header stands alone, and that what it declares is exported.
#include <rosefusion/vulkan.h>

#include <cstdio>

int main() {
  const rosefusion::VulkanRequirements needs = rosefusion::vulkanRequirements();
  try {
    rosefusion::missingFor({});
  } catch (const rosefusion::Error& error) {  // crosses the library's border as itself
    std::printf("%s\n", error.what());
    return needs.api_version == VK_API_VERSION_1_1 && error.kind() == rosefusion::Error::Kind::Misuse ? 0 : 1;
  }
  return 1;
}
