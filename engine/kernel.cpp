#include "engine/kernel.h"

#include "engine/error.h"
#include "engine/kernel_impl.h"
#include "engine/pool_bindings.h"
#include "engine/reflection.h"

namespace rosefusion {
namespace {

void requireMatch(const ShaderInterface& shader, const ShaderCode& code, std::uint32_t bindings,
                  std::uint32_t push_bytes, const DeviceInfo& device) {
  const auto fail = [&](DeviceErrorCode kind, const std::string& what) {
    throw DeviceError(kind, "Shader " + std::string(code.name) + ": " + what);
  };
  bool as_declared = shader.bindings.size() == bindings;
  for (std::uint32_t i = 0; as_declared && i < bindings; ++i) as_declared = shader.bindings[i].number == i;
  if (!as_declared)
    fail(DeviceErrorCode::Programming,
         "its buffer bindings are not 0 to " + std::to_string(bindings) + " - 1.");
  if (shader.push.bytes != push_bytes)
    fail(DeviceErrorCode::Programming, "it declares " + std::to_string(shader.push.bytes) +
                                           " B of push constants, the pass " + std::to_string(push_bytes) +
                                           " B.");
  const std::uint32_t invocations = shader.workgroup[0] * shader.workgroup[1] * shader.workgroup[2];
  if (invocations > device.limits.max_workgroup_invocations)
    fail(DeviceErrorCode::MissingLimit, "its workgroup of " + std::to_string(invocations) + " is more than " +
                                            device.name + " runs; choose another device.");
}

}  // namespace

VkDescriptorType descriptorType(BindingKind kind) {
  switch (kind) {
    case BindingKind::Storage:
      return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::Uniform:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    default:
      return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
  }
}

ShaderCode readerCode(const Device& device, std::string_view name) {
  return shaderCode(device.info().readsTexels() ? std::string(name) + "_texels" : std::string(name));
}

Kernel::Kernel(Device& owner, const ShaderCode& code, std::uint32_t bindings, std::uint32_t push_bytes,
               const std::vector<std::uint32_t>& constants)
    : impl_(new Impl) {
  const ShaderInterface shader = reflect(code);
  requireMatch(shader, code, bindings, push_bytes, owner.info());
  const Device::Impl& device = owner.impl();
  impl_->name = code.name;
  impl_->given = bindings;
  OnePoolModule one_pool;
  if (!owner.info().bindsAllChunks()) one_pool = withOnePool(code);
  if (one_pool.words.empty()) {
    for (std::uint32_t i = 0; i < bindings; ++i) impl_->kept.push_back(i);
  } else {
    impl_->kept = one_pool.kept;
    if (impl_->kept.size() < bindings && (constants.empty() || constants.front() != 1))
      throw DeviceError(DeviceErrorCode::Programming,
                        "Shader " + impl_->name + ": this device binds one chunk of a pool.");
  }
  for (const std::uint32_t i : impl_->kept) impl_->kinds.push_back(shader.bindings[i].kind);
  const std::span<const std::uint32_t> words = one_pool.words.empty() ? code.words : one_pool.words;
  const auto bound = static_cast<std::uint32_t>(impl_->kept.size());
  impl_->push_bytes = push_bytes;
  impl_->workgroup = shader.workgroup;
  const std::string doing = "building the shader " + impl_->name;

  std::vector<VkDescriptorSetLayoutBinding> set;
  for (std::uint32_t i = 0; i < bound; ++i)
    set.push_back({i, descriptorType(impl_->kinds[i]), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  impl_->set_layout = {
      device,
      VkDescriptorSetLayoutCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                      .bindingCount = bound,
                                      .pBindings = set.data()},
      doing};
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  impl_->pipeline_layout = {device,
                            VkPipelineLayoutCreateInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                       .setLayoutCount = 1,
                                                       .pSetLayouts = impl_->set_layout.address(),
                                                       .pushConstantRangeCount = push_bytes > 0 ? 1u : 0u,
                                                       .pPushConstantRanges = &push},
                            doing};

  const OwnedShaderModule module(
      device,
      VkShaderModuleCreateInfo{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                               .codeSize = words.size_bytes(),
                               .pCode = words.data()},
      doing);
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, 4 * i, 4});
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            4 * constants.size(), constants.data()};
  const VkPipelineShaderStageCreateInfo stage{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                              .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                              .module = module,
                                              .pName = "main",
                                              .pSpecializationInfo = &specialisation};
  impl_->pipeline = {device,
                     VkComputePipelineCreateInfo{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                                 .stage = stage,
                                                 .layout = impl_->pipeline_layout},
                     doing};
}

Kernel::Kernel() = default;
Kernel::~Kernel() = default;
Kernel::Kernel(Kernel&&) noexcept = default;
Kernel& Kernel::operator=(Kernel&&) noexcept = default;

}  // namespace rosefusion
