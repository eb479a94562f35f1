// Owners of Vulkan objects that are made on a device; included by engine/*.cpp only.
#pragma once
#include <string_view>
#include <type_traits>
#include <utility>

#include "engine/commands.h"

namespace rosefusion {

/// Throws a DeviceError unless `result` is VK_SUCCESS; `doing` completes "... failed while <doing>".
void require(VkResult result, std::string_view doing);

/// What it takes to make and to destroy.
struct Maker {
  Commands vk;
  VkDevice device = nullptr;
  const VkAllocationCallbacks* allocator = nullptr;
  VkPipelineCache pipeline_cache = nullptr;
};

/// One Vulkan object, or null. Movable; the Maker must outlive it.
template <typename Handle, auto Create, auto Destroy>
class Owned {
 public:
  Owned() = default;
  /// Throws as require() does.
  template <typename Info>
  Owned(const Maker& maker, const Info& info, std::string_view doing) {
    require(make(maker, info), doing);
  }
  Owned(Owned&& other) noexcept : maker_(other.maker_), handle_(std::exchange(other.handle_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(maker_, other.maker_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() {
    if (handle_) (maker_->vk.*Destroy)(maker_->device, handle_, maker_->allocator);
  }

  /// Of a null one; it stays null unless the result is VK_SUCCESS.
  template <typename Info>
  [[nodiscard]] VkResult make(const Maker& maker, const Info& info) {
    Handle made = nullptr;
    VkResult result;
    if constexpr (std::is_same_v<Info, VkComputePipelineCreateInfo>)
      result = (maker.vk.*Create)(maker.device, maker.pipeline_cache, 1, &info, maker.allocator, &made);
    else
      result = (maker.vk.*Create)(maker.device, &info, maker.allocator, &made);
    maker_ = &maker;
    if (result == VK_SUCCESS) handle_ = made;
    return result;
  }

  operator Handle() const { return handle_; }
  const Handle* address() const { return &handle_; }

 private:
  const Maker* maker_ = nullptr;
  Handle handle_ = nullptr;
};

using OwnedBuffer = Owned<VkBuffer, &Commands::CreateBuffer, &Commands::DestroyBuffer>;
using OwnedBufferView = Owned<VkBufferView, &Commands::CreateBufferView, &Commands::DestroyBufferView>;
using OwnedMemory = Owned<VkDeviceMemory, &Commands::AllocateMemory, &Commands::FreeMemory>;
using OwnedCommandPool = Owned<VkCommandPool, &Commands::CreateCommandPool, &Commands::DestroyCommandPool>;
using OwnedDescriptorPool =
    Owned<VkDescriptorPool, &Commands::CreateDescriptorPool, &Commands::DestroyDescriptorPool>;
using OwnedFence = Owned<VkFence, &Commands::CreateFence, &Commands::DestroyFence>;
using OwnedPipeline = Owned<VkPipeline, &Commands::CreateComputePipelines, &Commands::DestroyPipeline>;
using OwnedPipelineCache =
    Owned<VkPipelineCache, &Commands::CreatePipelineCache, &Commands::DestroyPipelineCache>;
using OwnedPipelineLayout =
    Owned<VkPipelineLayout, &Commands::CreatePipelineLayout, &Commands::DestroyPipelineLayout>;
using OwnedSetLayout =
    Owned<VkDescriptorSetLayout, &Commands::CreateDescriptorSetLayout, &Commands::DestroyDescriptorSetLayout>;
using OwnedShaderModule =
    Owned<VkShaderModule, &Commands::CreateShaderModule, &Commands::DestroyShaderModule>;

}  // namespace rosefusion
