#include "engine/recorder.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "engine/buffer_impl.h"
#include "engine/error.h"
#include "engine/kernel_impl.h"

namespace rosefusion {
namespace {
constexpr std::uint32_t kSetsPerSubmit = 256;
constexpr std::uint32_t kDescriptorsPerSubmit = kSetsPerSubmit * 20;
constexpr std::chrono::microseconds kSoon(1000);  // most submits of a search end within

bool readsTexels(BindingKind kind) {
  return descriptorType(kind) == vk::DescriptorType::eUniformTexelBuffer;
}

void requireInside(const Buffer& buffer, std::uint64_t offset, std::uint64_t bytes) {
  if (offset > buffer.bytes() || bytes > buffer.bytes() - offset)
    throw DeviceError(DeviceErrorCode::Programming, "A copy or fill reaches past the end of a buffer.");
}
}  // namespace

struct Recorder::Impl {
  Device::Impl& device;
  vk::raii::CommandPool command_pool = nullptr;  // one each, so that recorders may work on several threads
  vk::raii::CommandBuffer own_commands = nullptr;
  vk::CommandBuffer commands;  // own_commands, or the caller's
  vk::raii::DescriptorPool pool = nullptr;
  vk::raii::Fence fence = nullptr;
  std::uint32_t sets_used = 0;  // freed with the pool's reset
  bool recording = false;
  std::vector<Buffer> held;  // what the caller's command buffer uses

  const vk::raii::DeviceDispatcher& vulkan() const { return *device.device.getDispatcher(); }
  bool isCallers() const { return commands != *own_commands; }
  void begin() {
    if (recording) return;
    if (!isCallers())
      own_commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
    recording = true;
  }
  void hold(std::initializer_list<const Buffer*> buffers) {
    if (isCallers())
      for (const Buffer* buffer : buffers) held.push_back(*buffer);
  }
  void letGo() {
    pool.reset();
    sets_used = 0;
    held.clear();
  }
  /// Asks again and again for a while, which ends sooner than a sleeping thread wakes. A CPU that is the
  /// device has better to do.
  bool isSoonDone() const {
    if (device.info.type == DeviceType::Cpu) return false;
    const auto end = std::chrono::steady_clock::now() + kSoon;
    while (std::chrono::steady_clock::now() < end)
      if (fence.getStatus() == vk::Result::eSuccess) return true;
    return false;
  }
  void barrier() {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    makeVisible(Stage::eComputeShader | Stage::eTransfer, Access::eShaderRead | Access::eUniformRead |
                                                              Access::eShaderWrite | Access::eTransferRead |
                                                              Access::eTransferWrite);
    if (isCallers()) showHost();  // who knows after which command the caller looks
  }
  void showHost() { makeVisible(vk::PipelineStageFlagBits::eHost, vk::AccessFlagBits::eHostRead); }
  void makeVisible(vk::PipelineStageFlags stages, vk::AccessFlags to) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    const vk::MemoryBarrier written(Access::eShaderWrite | Access::eTransferWrite, to);
    commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, stages, {}, written, {}, {}, vulkan());
  }
  void bind(const Kernel::Impl& kernel, std::span<const Buffer* const> buffers, const void* push,
            std::uint32_t push_bytes) {
    if (buffers.size() != kernel.kinds.size() || push_bytes != kernel.push_bytes)
      throw DeviceError(DeviceErrorCode::Programming, "Kernel " + kernel.name + " was given " +
                                                          std::to_string(buffers.size()) + " buffers and " +
                                                          std::to_string(push_bytes) + " B of constants.");
    for (const Buffer* buffer : buffers)
      if (!buffer || !*buffer)
        throw DeviceError(DeviceErrorCode::Programming,
                          "Kernel " + kernel.name + " was given an empty buffer.");
    std::vector<vk::BufferView> views(buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      if (!readsTexels(kernel.kinds[i])) continue;
      const Buffer::Impl& buffer = buffers[i]->impl();
      views[i] = *(kernel.kinds[i] == BindingKind::WordTexels ? buffer.words : buffer.vectors);
      if (!views[i])
        throw DeviceError(DeviceErrorCode::Programming,
                          "Kernel " + kernel.name + " was given a buffer too large for the device's texels.");
    }
    if (sets_used == kSetsPerSubmit)
      throw DeviceError(DeviceErrorCode::Programming,
                        "More than " + std::to_string(kSetsPerSubmit) + " dispatches in one submit.");
    begin();
    const vk::DescriptorSetLayout layout = *kernel.set_layout;
    // Allocated unowned: the pool is reset as a whole after each submit.
    const vk::DescriptorSet set =
        (*device.device).allocateDescriptorSets(vk::DescriptorSetAllocateInfo(*pool, layout), vulkan())[0];
    ++sets_used;
    std::vector<vk::DescriptorBufferInfo> infos;
    infos.reserve(buffers.size());
    for (const Buffer* buffer : buffers) {
      infos.emplace_back(*buffer->impl().buffer, 0, VK_WHOLE_SIZE);
      hold({buffer});
    }
    std::vector<vk::WriteDescriptorSet> writes;
    for (std::uint32_t i = 0; i < infos.size(); ++i) {
      const bool texels = readsTexels(kernel.kinds[i]);
      writes.emplace_back(set, i, 0, 1, descriptorType(kernel.kinds[i]), nullptr,
                          texels ? nullptr : &infos[i], texels ? &views[i] : nullptr);
    }
    device.device.updateDescriptorSets(writes, {});
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *kernel.pipeline, vulkan());
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *kernel.pipeline_layout, 0, set, {},
                                vulkan());
    if (push_bytes > 0)
      commands.pushConstants(*kernel.pipeline_layout, vk::ShaderStageFlagBits::eCompute, 0, push_bytes, push,
                             vulkan());
  }
};

Recorder::Recorder(Device& owner) : impl_(new Impl{owner.impl()}) {
  Device::Impl& device = impl_->device;
  try {
    impl_->command_pool = {
        device.device,
        vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eResetCommandBuffer, device.queue_family),
        device.allocator};
    impl_->own_commands = std::move(
        vk::raii::CommandBuffers(device.device, {*impl_->command_pool, vk::CommandBufferLevel::ePrimary, 1})
            .front());
    impl_->commands = *impl_->own_commands;
    const std::array sizes = {
        vk::DescriptorPoolSize(vk::DescriptorType::eStorageBuffer, kDescriptorsPerSubmit),
        vk::DescriptorPoolSize(vk::DescriptorType::eUniformBuffer, kDescriptorsPerSubmit),
        vk::DescriptorPoolSize(vk::DescriptorType::eUniformTexelBuffer, kDescriptorsPerSubmit)};
    impl_->pool = {device.device, vk::DescriptorPoolCreateInfo({}, kSetsPerSubmit, sizes), device.allocator};
    impl_->fence = {device.device, vk::FenceCreateInfo(), device.allocator};
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "making a command buffer");
  }
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::dispatchBytes(const Kernel& kernel, std::span<const Buffer* const> buffers, const void* push,
                             std::uint32_t push_bytes, Threads threads) {
  const auto& group = kernel.impl().workgroup;
  const std::uint32_t along_x = (threads.x + group[0] - 1) / group[0];
  if (const DeviceInfo& info = impl_->device.info; along_x > info.limits.max_workgroup_count_x)
    throw DeviceError(DeviceErrorCode::MissingLimit,
                      "Kernel " + kernel.impl().name + ": " + std::to_string(along_x) +
                          " workgroups are more than the " +
                          std::to_string(info.limits.max_workgroup_count_x) + " that " + info.name +
                          " runs; give it smaller images.");
  impl_->bind(kernel.impl(), buffers, push, push_bytes);
  impl_->commands.dispatch(along_x, (threads.y + group[1] - 1) / group[1],
                           (threads.z + group[2] - 1) / group[2], impl_->vulkan());
  impl_->barrier();
}

void Recorder::dispatchGroups(const Kernel& kernel, std::span<const Buffer* const> buffers, const void* push,
                              std::uint32_t push_bytes, std::uint32_t groups) {
  if (groups == 0) return;
  impl_->bind(kernel.impl(), buffers, push, push_bytes);
  const std::uint32_t widest = std::min(32768u, impl_->device.info.limits.max_workgroup_count_x);
  const std::uint32_t rows = (groups + widest - 1) / widest;
  impl_->commands.dispatch(std::min(groups, widest), rows, 1, impl_->vulkan());
  impl_->barrier();
}

void Recorder::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t from_offset,
                    std::uint64_t to_offset) {
  if (bytes == 0) return;
  requireInside(from, from_offset, bytes);
  requireInside(to, to_offset, bytes);
  impl_->begin();
  impl_->commands.copyBuffer(*from.impl().buffer, *to.impl().buffer,
                             vk::BufferCopy(from_offset, to_offset, bytes), impl_->vulkan());
  impl_->hold({&from, &to});
  impl_->barrier();
}

void Recorder::copyToImage(const Buffer& from, VkImage_T* image, ImageAspect aspect, std::uint32_t width,
                           std::uint32_t height, bool general) {
  requireInside(from, 0, 4ull * width * height);
  impl_->begin();
  const vk::ImageSubresourceLayers layers(
      aspect == ImageAspect::Colour ? vk::ImageAspectFlagBits::eColor : vk::ImageAspectFlagBits::eDepth, 0, 0,
      1);
  impl_->commands.copyBufferToImage(
      *from.impl().buffer, vk::Image(image),
      general ? vk::ImageLayout::eGeneral : vk::ImageLayout::eTransferDstOptimal,
      vk::BufferImageCopy(0, 0, 0, layers, {}, {width, height, 1}), impl_->vulkan());
  impl_->hold({&from});
  impl_->barrier();
}

void Recorder::copyPixels(const DevicePixels& from, const Buffer& to, std::uint32_t width,
                          std::uint32_t height, std::uint32_t bytes_per_pixel) {
  const std::uint64_t bytes = std::uint64_t(width) * height * bytes_per_pixel;
  requireInside(to, 0, bytes);
  if (!from.buffer && !from.image)
    throw DeviceError(DeviceErrorCode::Programming, "Pixels on the device need a buffer or an image.");
  impl_->begin();
  if (from.buffer) {
    impl_->commands.copyBuffer(vk::Buffer(from.buffer), *to.impl().buffer,
                               vk::BufferCopy(from.offset, 0, bytes), impl_->vulkan());
  } else {
    const vk::ImageSubresourceLayers layers(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
    impl_->commands.copyImageToBuffer(
        vk::Image(from.image),
        from.general ? vk::ImageLayout::eGeneral : vk::ImageLayout::eTransferSrcOptimal, *to.impl().buffer,
        vk::BufferImageCopy(0, 0, 0, layers, {}, {width, height, 1}), impl_->vulkan());
  }
  impl_->hold({&to});
  impl_->barrier();
}

void Recorder::fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes) {
  if (bytes == 0) return;
  requireInside(buffer, offset, bytes);
  impl_->begin();
  impl_->commands.fillBuffer(*buffer.impl().buffer, offset, bytes, word, impl_->vulkan());
  impl_->hold({&buffer});
  impl_->barrier();
}

void Recorder::recordInto(VkCommandBuffer_T* commands) {
  if (impl_->recording && !impl_->isCallers())
    throw DeviceError(DeviceErrorCode::Programming, "What was recorded before must be submitted first.");
  impl_->letGo();
  impl_->recording = false;
  impl_->commands = commands ? vk::CommandBuffer(commands) : *impl_->own_commands;
}

void Recorder::submit() {
  if (impl_->isCallers())
    throw DeviceError(DeviceErrorCode::Programming,
                      "A caller's command buffer is submitted by the caller, not by the engine.");
  if (!impl_->recording) return;
  Device::Impl& device = impl_->device;
  try {
    impl_->showHost();
    impl_->own_commands.end();
    impl_->recording = false;
    device.submit(vk::SubmitInfo({}, {}, impl_->commands), *impl_->fence);
    if (!impl_->isSoonDone() &&
        device.device.waitForFences(*impl_->fence, true, std::numeric_limits<std::uint64_t>::max()) !=
            vk::Result::eSuccess)
      throw DeviceError(DeviceErrorCode::DeviceLost, device.info.name + " did not finish its work.");
    device.device.resetFences(*impl_->fence);
    impl_->letGo();
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, "running compute work");
  }
}

}  // namespace rosefusion
