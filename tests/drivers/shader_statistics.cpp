// What a driver makes of shaders: shader_statistics SPIRV [CONSTANT...] prints one line of "name value|" for
// the compute shader with those specialisation constants, or how the first device's driver refuses it.
// Nothing is run, so drivers without their hardware will do.
#include <spirv_cross/spirv_cross_c.h>
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

void check(VkResult result, const char* doing) {
  if (result >= 0) return;
  std::fprintf(stderr, "shader_statistics: %s failed with %d.\n", doing, result);
  std::exit(1);
}

std::vector<std::uint32_t> readWords(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::vector<std::uint32_t> words(bytes.size() / 4);
  bytes.copy(reinterpret_cast<char*>(words.data()), 4 * words.size());
  if (words.empty()) {
    std::fprintf(stderr, "shader_statistics: %s cannot be read.\n", path);
    std::exit(1);
  }
  return words;
}

std::vector<VkDescriptorSetLayoutBinding> bindingsOf(const std::vector<std::uint32_t>& words) {
  spvc_context context = nullptr;
  spvc_parsed_ir ir = nullptr;
  spvc_compiler compiler = nullptr;
  spvc_resources resources = nullptr;
  if (spvc_context_create(&context) != SPVC_SUCCESS ||
      spvc_context_parse_spirv(context, words.data(), words.size(), &ir) != SPVC_SUCCESS ||
      spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP,
                                   &compiler) != SPVC_SUCCESS ||
      spvc_compiler_create_shader_resources(compiler, &resources) != SPVC_SUCCESS) {
    std::fprintf(stderr, "shader_statistics: this is no SPIR-V.\n");
    std::exit(1);
  }
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const auto& [kind, type] :
       {std::pair{SPVC_RESOURCE_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
        std::pair{SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
        std::pair{SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER}}) {
    const spvc_reflected_resource* list = nullptr;
    std::size_t count = 0;
    spvc_resources_get_resource_list_for_type(resources, kind, &list, &count);
    for (std::size_t i = 0; i < count; ++i)
      bindings.push_back({spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding), type, 1,
                          VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  }
  spvc_context_destroy(context);
  return bindings;
}

void print(VkDevice device, VkPipeline pipeline) {
  const auto properties = reinterpret_cast<PFN_vkGetPipelineExecutablePropertiesKHR>(
      vkGetDeviceProcAddr(device, "vkGetPipelineExecutablePropertiesKHR"));
  const auto statistics = reinterpret_cast<PFN_vkGetPipelineExecutableStatisticsKHR>(
      vkGetDeviceProcAddr(device, "vkGetPipelineExecutableStatisticsKHR"));
  const VkPipelineInfoKHR of{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, nullptr, pipeline};
  std::uint32_t count = 1;
  VkPipelineExecutablePropertiesKHR property{};
  property.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR;
  check(properties(device, &of, &count, &property), "asking for the executable");
  const VkPipelineExecutableInfoKHR executable{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, nullptr,
                                               pipeline, 0};
  check(statistics(device, &executable, &count, nullptr), "asking for statistics");
  std::vector<VkPipelineExecutableStatisticKHR> all(count);
  for (auto& one : all) one.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR;
  check(statistics(device, &executable, &count, all.data()), "asking for statistics");
  std::printf("Lanes %u|", property.subgroupSize);
  for (const auto& one : all)
    if (one.format == VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR)
      std::printf("%s %llu|", one.name, static_cast<unsigned long long>(one.value.u64));
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "use: shader_statistics SPIRV [CONSTANT...]\n");
    return 2;
  }
  const std::vector<std::uint32_t> words = readWords(argv[1]);
  std::vector<std::uint32_t> constants;
  for (int i = 2; i < argc; ++i)
    constants.push_back(static_cast<std::uint32_t>(std::strtoul(argv[i], nullptr, 0)));

  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.apiVersion = VK_API_VERSION_1_1;
  VkInstanceCreateInfo instance_info{};
  instance_info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  instance_info.pApplicationInfo = &application;
  VkInstance instance = nullptr;
  check(vkCreateInstance(&instance_info, nullptr, &instance), "making an instance");
  std::uint32_t count = 1;
  VkPhysicalDevice physical = nullptr;
  check(vkEnumeratePhysicalDevices(instance, &count, &physical), "looking for a device");
  if (count == 0) {
    std::fprintf(stderr, "shader_statistics: the driver offers no device.\n");
    return 1;
  }
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR feature{};
  feature.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR;
  feature.pipelineExecutableInfo = VK_TRUE;
  const char* extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
  VkDeviceCreateInfo device_info{};
  device_info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  device_info.pNext = &feature;
  device_info.queueCreateInfoCount = 1;
  device_info.pQueueCreateInfos = &queue;
  device_info.enabledExtensionCount = 1;
  device_info.ppEnabledExtensionNames = &extension;
  VkDevice device = nullptr;
  check(vkCreateDevice(physical, &device_info, nullptr, &device), "making a device with pipeline statistics");

  const std::vector<VkDescriptorSetLayoutBinding> bindings = bindingsOf(words);
  VkDescriptorSetLayoutCreateInfo set_info{};
  set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set_info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set_info.pBindings = bindings.data();
  VkDescriptorSetLayout set = nullptr;
  check(vkCreateDescriptorSetLayout(device, &set_info, nullptr, &set), "making the layout");
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, 128};
  VkPipelineLayoutCreateInfo layout_info{};
  layout_info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &set;
  layout_info.pushConstantRangeCount = 1;
  layout_info.pPushConstantRanges = &push;
  VkPipelineLayout layout = nullptr;
  check(vkCreatePipelineLayout(device, &layout_info, nullptr, &layout), "making the layout");
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = 4 * words.size();
  module_info.pCode = words.data();
  VkShaderModule module = nullptr;
  check(vkCreateShaderModule(device, &module_info, nullptr, &module), "reading the shader");
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, 4 * i, 4});
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            4 * constants.size(), constants.data()};
  VkComputePipelineCreateInfo pipeline_info{};
  pipeline_info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  pipeline_info.flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
  pipeline_info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  pipeline_info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  pipeline_info.stage.module = module;
  pipeline_info.stage.pName = "main";
  pipeline_info.stage.pSpecializationInfo = &specialisation;
  pipeline_info.layout = layout;
  VkPipeline pipeline = nullptr;
  check(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipeline_info, nullptr, &pipeline), "compiling");
  print(device, pipeline);
}
