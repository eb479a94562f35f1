#include "tests/host/embedding/caller_shader.h"

namespace rosefusion::testing {

#define COMMAND(NAME) caller.command<PFN_##NAME>(#NAME)

void runShader(Caller& caller, std::span<const std::uint32_t> words, std::uint32_t constant,
               const std::vector<VkBuffer>& buffers, std::uint32_t groups) {
  const auto count = static_cast<std::uint32_t>(buffers.size());
  VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  module_info.codeSize = words.size_bytes();
  module_info.pCode = words.data();
  VkShaderModule module;
  COMMAND(vkCreateShaderModule)(caller.device, &module_info, nullptr, &module);

  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (std::uint32_t i = 0; i < count; ++i)
    bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_info.bindingCount = count;
  set_info.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout;
  COMMAND(vkCreateDescriptorSetLayout)(caller.device, &set_info, nullptr, &set_layout);
  VkPipelineLayoutCreateInfo layout_info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &set_layout;
  VkPipelineLayout layout;
  COMMAND(vkCreatePipelineLayout)(caller.device, &layout_info, nullptr, &layout);

  const VkSpecializationMapEntry entry{0, 0, 4};
  const VkSpecializationInfo specialisation{1, &entry, 4, &constant};
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialisation;
  info.layout = layout;
  VkPipeline pipeline;
  COMMAND(vkCreateComputePipelines)(caller.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count};
  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  VkDescriptorPool pool;
  COMMAND(vkCreateDescriptorPool)(caller.device, &pool_info, nullptr, &pool);
  VkDescriptorSetAllocateInfo set_allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  set_allocation.descriptorPool = pool;
  set_allocation.descriptorSetCount = 1;
  set_allocation.pSetLayouts = &set_layout;
  VkDescriptorSet set;
  COMMAND(vkAllocateDescriptorSets)(caller.device, &set_allocation, &set);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkDescriptorBufferInfo whole{buffers[i], 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = i;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &whole;
    COMMAND(vkUpdateDescriptorSets)(caller.device, 1, &write, 0, nullptr);
  }

  caller.frame([&](VkCommandBuffer commands) {
    COMMAND(vkCmdBindPipeline)(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    COMMAND(vkCmdBindDescriptorSets)
    (commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, nullptr);
    COMMAND(vkCmdDispatch)(commands, groups, 1, 1);
    VkMemoryBarrier done{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    done.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
    done.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_HOST_READ_BIT;
    COMMAND(vkCmdPipelineBarrier)
    (commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
     &done, 0, nullptr, 0, nullptr);
  });
  COMMAND(vkDestroyDescriptorPool)(caller.device, pool, nullptr);
  COMMAND(vkDestroyPipeline)(caller.device, pipeline, nullptr);
  COMMAND(vkDestroyPipelineLayout)(caller.device, layout, nullptr);
  COMMAND(vkDestroyDescriptorSetLayout)(caller.device, set_layout, nullptr);
  COMMAND(vkDestroyShaderModule)(caller.device, module, nullptr);
}

}  // namespace rosefusion::testing
