#include "engine/kernel.h"

#include "engine/error.h"
#include "engine/kernel_impl.h"
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

vk::DescriptorType descriptorType(BindingKind kind) {
  switch (kind) {
    case BindingKind::Storage:
      return vk::DescriptorType::eStorageBuffer;
    case BindingKind::Uniform:
      return vk::DescriptorType::eUniformBuffer;
    default:
      return vk::DescriptorType::eUniformTexelBuffer;
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
  Device::Impl& device = owner.impl();
  impl_->name = code.name;
  for (const ShaderBinding& binding : shader.bindings) impl_->kinds.push_back(binding.kind);
  impl_->push_bytes = push_bytes;
  impl_->workgroup = shader.workgroup;
  try {
    std::vector<vk::DescriptorSetLayoutBinding> set;
    for (std::uint32_t i = 0; i < bindings; ++i)
      set.emplace_back(i, descriptorType(impl_->kinds[i]), 1, vk::ShaderStageFlagBits::eCompute);
    impl_->set_layout = {device.device, vk::DescriptorSetLayoutCreateInfo({}, set), device.allocator};
    const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0, push_bytes);
    vk::PipelineLayoutCreateInfo layout({}, *impl_->set_layout);
    if (push_bytes > 0) layout.setPushConstantRanges(push);
    impl_->pipeline_layout = {device.device, layout, device.allocator};

    const vk::raii::ShaderModule module(
        device.device, vk::ShaderModuleCreateInfo({}, code.words.size_bytes(), code.words.data()),
        device.allocator);
    std::vector<vk::SpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < constants.size(); ++i) entries.emplace_back(i, 4 * i, 4);
    const vk::SpecializationInfo specialisation(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                                4 * constants.size(), constants.data());
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                  &specialisation);
    // Not by the RAII class, which takes only a cache of its own kind.
    const vk::ComputePipelineCreateInfo pipeline({}, stage, *impl_->pipeline_layout);
    const auto made = (*device.device)
                          .createComputePipeline(device.pipeline_cache, pipeline, device.allocator,
                                                 *device.device.getDispatcher());
    impl_->pipeline = {device.device, made.value, device.allocator};
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "building the shader " + impl_->name);
  }
}

Kernel::Kernel() = default;
Kernel::~Kernel() = default;
Kernel::Kernel(Kernel&&) noexcept = default;
Kernel& Kernel::operator=(Kernel&&) noexcept = default;

}  // namespace rosefusion
