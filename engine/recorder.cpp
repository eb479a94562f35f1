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
constexpr int kLastWaits = 3;                     // for work whose recorder goes

VkBufferImageCopy wholeImage(VkImageAspectFlags aspect, std::uint32_t width, std::uint32_t height) {
  return {.imageSubresource = {aspect, 0, 0, 1}, .imageExtent = {width, height, 1}};
}

bool readsTexels(BindingKind kind) {
  return descriptorType(kind) == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

void requireInside(const Buffer& buffer, std::uint64_t offset, std::uint64_t bytes) {
  if (offset > buffer.bytes() || bytes > buffer.bytes() - offset)
    throw DeviceError(DeviceErrorCode::Programming, "A copy or fill reaches past the end of a buffer.");
}
}  // namespace

struct Recorder::Impl {
  Device::Impl& device;
  OwnedCommandPool command_pool;  // one each, so that recorders may work on several threads
  VkCommandBuffer own_commands = nullptr;
  VkCommandBuffer commands = nullptr;  // own_commands, or the caller's
  OwnedDescriptorPool pool;
  OwnedFence fence;
  std::uint32_t sets_used = 0;  // freed with the pool's reset
  bool recording = false;
  bool running = false;      // own_commands are the device's
  std::vector<Buffer> held;  // what the recorded commands use
  std::vector<std::shared_ptr<Kernel::Impl>> held_kernels;

  const Commands& vk() const { return device.vk; }
  bool isCallers() const { return commands != own_commands; }
  ~Impl() {
    for (int attempt = 0; running && attempt < kLastWaits; ++attempt) {
      try {
        finish();
      } catch (const DeviceError&) {  // nobody is left to hear of it
      }
    }
  }
  void begin() {
    if (recording) return;
    finish();
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (!isCallers()) require(vk().BeginCommandBuffer(own_commands, &info), "beginning a command buffer");
    recording = true;
  }
  void hold(std::initializer_list<const Buffer*> buffers) {
    for (const Buffer* buffer : buffers) held.push_back(*buffer);
  }
  void letGo() {
    (void)vk().ResetDescriptorPool(device.device, pool, 0);  // cannot fail
    sets_used = 0;
    held.clear();
    held_kernels.clear();
  }
  /// Asks again and again for a while, which ends sooner than a sleeping thread wakes. A CPU that is the
  /// device has better to do.
  bool isSoonDone() const {
    if (device.info.type == DeviceType::Cpu) return false;
    const auto end = std::chrono::steady_clock::now() + kSoon;
    while (std::chrono::steady_clock::now() < end)
      if (vk().GetFenceStatus(device.device, fence) == VK_SUCCESS) return true;
    return false;
  }
  /// Where the wait itself fails the work may still run: it is waited for again before anything else is
  /// recorded. Of a lost device there is nothing more to wait for.
  void finish() {
    if (!running) return;
    const VkFence* waited = fence.address();
    const char* doing = "running compute work";
    if (!isSoonDone()) {
      const VkResult result =
          vk().WaitForFences(device.device, 1, waited, VK_TRUE, std::numeric_limits<std::uint64_t>::max());
      if (result == VK_ERROR_DEVICE_LOST) {
        running = false;
        letGo();
      }
      require(result, doing);
    }
    require(vk().ResetFences(device.device, 1, waited), doing);  // else it would tell of the next work's end
    running = false;
    letGo();
  }
  void barrier() {
    makeVisible(VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_UNIFORM_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                    VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT);
    if (isCallers()) showHost();  // who knows after which command the caller looks
  }
  void showHost() { makeVisible(VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT); }
  void makeVisible(VkPipelineStageFlags stages, VkAccessFlags to) {
    const VkMemoryBarrier written{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr,
                                  VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, to};
    vk().CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                            stages, 0, 1, &written, 0, nullptr, 0, nullptr);
  }
  void bind(const Kernel::Impl& kernel, std::span<const BoundBuffers> bound, const void* push,
            std::uint32_t push_bytes) {
    std::vector<const Buffer*> given, buffers;
    for (const BoundBuffers& several : bound)
      for (std::size_t i = 0; i < several.size(); ++i) given.push_back(&several[i]);
    if (given.size() != kernel.given || push_bytes != kernel.push_bytes)
      throw DeviceError(DeviceErrorCode::Programming, "Kernel " + kernel.name + " was given " +
                                                          std::to_string(given.size()) + " buffers and " +
                                                          std::to_string(push_bytes) + " B of constants.");
    for (const std::uint32_t i : kernel.kept) buffers.push_back(given[i]);
    for (const Buffer* buffer : buffers)
      if (!*buffer)
        throw DeviceError(DeviceErrorCode::Programming,
                          "Kernel " + kernel.name + " was given an empty buffer.");
    std::vector<VkBufferView> views(buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      if (!readsTexels(kernel.kinds[i])) continue;
      const Buffer::Impl& buffer = buffers[i]->impl();
      views[i] = kernel.kinds[i] == BindingKind::WordTexels ? buffer.words : buffer.vectors;
      if (!views[i])
        throw DeviceError(DeviceErrorCode::Programming,
                          "Kernel " + kernel.name + " was given a buffer too large for the device's texels.");
    }
    if (sets_used == kSetsPerSubmit)
      throw DeviceError(DeviceErrorCode::Programming,
                        "More than " + std::to_string(kSetsPerSubmit) + " dispatches in one submit.");
    begin();
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = kernel.set_layout.address()};
    VkDescriptorSet set = nullptr;  // freed with the pool's reset after each submit
    require(vk().AllocateDescriptorSets(device.device, &info, &set), "binding buffers");
    ++sets_used;
    std::vector<VkDescriptorBufferInfo> infos;
    for (const Buffer* buffer : buffers) {
      infos.push_back({buffer->impl().buffer, 0, VK_WHOLE_SIZE});
      hold({buffer});
    }
    std::vector<VkWriteDescriptorSet> writes;
    for (std::uint32_t i = 0; i < infos.size(); ++i)
      writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                        .dstSet = set,
                        .dstBinding = i,
                        .descriptorCount = 1,
                        .descriptorType = descriptorType(kernel.kinds[i]),
                        .pBufferInfo = &infos[i],
                        .pTexelBufferView = &views[i]});
    ++device.work.dispatches;
    vk().UpdateDescriptorSets(device.device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                              nullptr);
    vk().CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline);
    vk().CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline_layout, 0, 1, &set,
                               0, nullptr);
    if (push_bytes > 0)
      vk().CmdPushConstants(commands, kernel.pipeline_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes,
                            push);
  }
};

Recorder::Recorder(Device& owner) : impl_(new Impl{owner.impl()}) {
  const Device::Impl& device = impl_->device;
  const char* doing = "making a command buffer";
  impl_->command_pool = {device,
                         VkCommandPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                 .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                                 .queueFamilyIndex = device.queue_family},
                         doing};
  const VkCommandBufferAllocateInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = impl_->command_pool,
                                             .commandBufferCount = 1};
  require(device.vk.AllocateCommandBuffers(device.device, &commands, &impl_->own_commands), doing);
  impl_->commands = impl_->own_commands;
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kDescriptorsPerSubmit},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, kDescriptorsPerSubmit},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kDescriptorsPerSubmit}};
  impl_->pool = {device,
                 VkDescriptorPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .maxSets = kSetsPerSubmit,
                                            .poolSizeCount = static_cast<std::uint32_t>(std::size(sizes)),
                                            .pPoolSizes = sizes},
                 doing};
  impl_->fence = {device, VkFenceCreateInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO}, doing};
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::dispatchBytes(const Kernel& kernel, std::span<const BoundBuffers> buffers, const void* push,
                             std::uint32_t push_bytes, Threads threads) {
  const auto& group = kernel.impl().workgroup;
  const std::uint32_t along_x = (threads.x + group[0] - 1) / group[0];
  if (const DeviceInfo& info = impl_->device.info; along_x > info.limits.max_workgroup_count_x)
    throw DeviceError(DeviceErrorCode::MissingLimit,
                      "Kernel " + kernel.impl().name + ": " + std::to_string(along_x) +
                          " workgroups are more than the " +
                          std::to_string(info.limits.max_workgroup_count_x) + " that " + info.name +
                          " runs; give it smaller images.");
  impl_->held_kernels.push_back(kernel.shared());
  impl_->bind(kernel.impl(), buffers, push, push_bytes);
  impl_->vk().CmdDispatch(impl_->commands, along_x, (threads.y + group[1] - 1) / group[1],
                          (threads.z + group[2] - 1) / group[2]);
  impl_->barrier();
}

void Recorder::dispatchBytes(const Kernel& kernel, std::span<const BoundBuffers> buffers, const void* push,
                             std::uint32_t push_bytes, Groups groups) {
  if (groups.count == 0) return;
  impl_->held_kernels.push_back(kernel.shared());
  impl_->bind(kernel.impl(), buffers, push, push_bytes);
  const std::uint32_t widest = std::min(32768u, impl_->device.info.limits.max_workgroup_count_x);
  const std::uint32_t rows = (groups.count + widest - 1) / widest;
  impl_->vk().CmdDispatch(impl_->commands, std::min(groups.count, widest), rows, 1);
  impl_->barrier();
}

void Recorder::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t from_offset,
                    std::uint64_t to_offset) {
  if (bytes == 0) return;
  requireInside(from, from_offset, bytes);
  requireInside(to, to_offset, bytes);
  impl_->begin();
  const VkBufferCopy region{from_offset, to_offset, bytes};
  impl_->vk().CmdCopyBuffer(impl_->commands, from.impl().buffer, to.impl().buffer, 1, &region);
  impl_->hold({&from, &to});
  impl_->device.work.copied_bytes += bytes;
  impl_->barrier();
}

void Recorder::copyToImage(const BufferPart& from, VkImage_T* image, ImageAspect aspect, std::uint32_t width,
                           std::uint32_t height, bool general) {
  requireInside(from.buffer, from.offset, 4ull * width * height);
  impl_->begin();
  VkBufferImageCopy region = wholeImage(
      aspect == ImageAspect::Colour ? VK_IMAGE_ASPECT_COLOR_BIT : VK_IMAGE_ASPECT_DEPTH_BIT, width, height);
  region.bufferOffset = from.offset;
  impl_->vk().CmdCopyBufferToImage(impl_->commands, from.buffer.impl().buffer, image,
                                   general ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                   1, &region);
  impl_->hold({&from.buffer});
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
    const VkBufferCopy region{from.offset, 0, bytes};
    impl_->vk().CmdCopyBuffer(impl_->commands, from.buffer, to.impl().buffer, 1, &region);
  } else {
    const VkBufferImageCopy region = wholeImage(VK_IMAGE_ASPECT_COLOR_BIT, width, height);
    impl_->vk().CmdCopyImageToBuffer(
        impl_->commands, from.image,
        from.general ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.impl().buffer, 1,
        &region);
  }
  impl_->hold({&to});
  impl_->barrier();
}

void Recorder::fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes) {
  if (bytes == 0) return;
  requireInside(buffer, offset, bytes);
  impl_->begin();
  impl_->vk().CmdFillBuffer(impl_->commands, buffer.impl().buffer, offset, bytes, word);
  impl_->hold({&buffer});
  impl_->barrier();
}

void Recorder::recordInto(VkCommandBuffer_T* commands) {
  finish();
  if (impl_->recording && !impl_->isCallers())
    throw DeviceError(DeviceErrorCode::Programming, "What was recorded before must be submitted first.");
  impl_->letGo();
  impl_->recording = false;
  impl_->commands = commands ? commands : impl_->own_commands;
}

void Recorder::discard() {
  if (!impl_->recording || impl_->isCallers()) return;
  (void)impl_->vk().ResetCommandBuffer(impl_->own_commands, 0);  // beginning it anew would say what is wrong
  impl_->recording = false;
  impl_->letGo();
}

void Recorder::submit() {
  start();
  finish();
}

void Recorder::start() {
  if (impl_->isCallers())
    throw DeviceError(DeviceErrorCode::Programming,
                      "A caller's command buffer is submitted by the caller, not by the engine.");
  if (!impl_->recording) return;
  Device::Impl& device = impl_->device;
  const char* doing = "running compute work";
  const VkSubmitInfo work{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &impl_->commands};
  const Whole whole(*this);
  impl_->showHost();
  require(device.vk.EndCommandBuffer(impl_->commands), doing);
  require(device.submit(work, *impl_->fence.address()), doing);
  ++device.work.submits;
  impl_->recording = false;
  impl_->running = true;
}

void Recorder::finish() {
  impl_->finish();
}

}  // namespace rosefusion
