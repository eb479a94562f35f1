#include "apps/viewer/canvas.h"

#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/viewer/imgui_versions.h"
#include "host/core/file_io.h"

namespace rosefusion::viewer {
namespace {

constexpr VkClearColorValue kBackground{{0.11f, 0.12f, 0.14f, 1}};

VkRenderPass makeRenderPass(VkDevice device) {
  VkAttachmentDescription picture{};
  picture.format = kFormat;
  picture.samples = VK_SAMPLE_COUNT_1_BIT;
  picture.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  picture.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  picture.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  picture.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  picture.initialLayout = picture.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  VkRenderPassCreateInfo create{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  create.attachmentCount = 1;
  create.pAttachments = &picture;
  create.subpassCount = 1;
  create.pSubpasses = &subpass;
  VkRenderPass pass = VK_NULL_HANDLE;
  require(vkCreateRenderPass(device, &create, nullptr, &pass), "preparing to draw");
  return pass;
}

}  // namespace

Canvas::Canvas(Gpu& gpu) : Canvas(&gpu) {
  render_pass_ = makeRenderPass(gpu.device);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, textureCount()};
  VkDescriptorPoolCreateInfo descriptors{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  descriptors.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  descriptors.maxSets = textureCount();
  descriptors.poolSizeCount = 1;
  descriptors.pPoolSizes = &size;
  require(vkCreateDescriptorPool(gpu.device, &descriptors, nullptr, &descriptors_), "preparing to draw");
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = gpu.queue_family;
  require(vkCreateCommandPool(gpu.device, &pool, nullptr, &pool_), "preparing to draw");
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  require(vkAllocateCommandBuffers(gpu.device, &allocate, &commands_), "preparing to draw");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  require(vkCreateFence(gpu.device, &fence, nullptr, &done_), "preparing to draw");

  has_panels_ = true;
  startRenderer(gpu, render_pass_, descriptors_, [this](const auto& record) {
    begin();
    record(commands_);
    finish(VK_NULL_HANDLE, VK_NULL_HANDLE);
  });
}

Canvas::~Canvas() {
  gpu_.waitUntilIdle();
  if (has_panels_) ImGui_ImplVulkan_Shutdown();
  destroyFramebuffer();
  image_ = {};
  vkDestroyFence(gpu_.device, done_, nullptr);
  vkDestroyCommandPool(gpu_.device, pool_, nullptr);
  vkDestroyDescriptorPool(gpu_.device, descriptors_, nullptr);
  vkDestroyRenderPass(gpu_.device, render_pass_, nullptr);
}

void Canvas::destroyFramebuffer() {
  if (framebuffer_) vkDestroyFramebuffer(gpu_.device, framebuffer_, nullptr);
  framebuffer_ = VK_NULL_HANDLE;
}

void Canvas::resize(int width, int height) {
  if (width == image_.width() && height == image_.height()) return;
  destroyFramebuffer();
  image_ = Image(gpu_, width, height, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  const VkImageView view = image_.view();
  VkFramebufferCreateInfo create{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  create.renderPass = render_pass_;
  create.attachmentCount = 1;
  create.pAttachments = &view;
  create.width = static_cast<std::uint32_t>(width);
  create.height = static_cast<std::uint32_t>(height);
  create.layers = 1;
  require(vkCreateFramebuffer(gpu_.device, &create, nullptr, &framebuffer_), "preparing to draw");
}

void Canvas::begin() {
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  require(vkBeginCommandBuffer(commands_, &info), "drawing");
}

void Canvas::finish(VkSemaphore wait, VkSemaphore signal) {
  require(vkEndCommandBuffer(commands_), "drawing");
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  VkSubmitInfo submission{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submission.waitSemaphoreCount = wait != VK_NULL_HANDLE;
  submission.pWaitSemaphores = &wait;
  submission.pWaitDstStageMask = &stage;
  submission.commandBufferCount = 1;
  submission.pCommandBuffers = &commands_;
  submission.signalSemaphoreCount = signal != VK_NULL_HANDLE;
  submission.pSignalSemaphores = &signal;
  gpu_.submit(submission, done_);
  require(vkWaitForFences(gpu_.device, 1, &done_, VK_TRUE, UINT64_MAX), "drawing");
  require(vkResetFences(gpu_.device, 1, &done_), "drawing");
}

void Canvas::draw(const std::function<void(VkCommandBuffer, VkImage)>& beneath,
                  const std::function<void(VkCommandBuffer, const Image&)>& after, VkSemaphore wait,
                  VkSemaphore signal) {
  updateTextures(gpu_);
  begin();
  image_.change(commands_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, true);
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands_, image_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &kBackground, 1,
                       &all);
  recordBarrier(commands_, image_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  beneath(commands_, image_.handle());
  image_.change(commands_, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  pass.renderPass = render_pass_;
  pass.framebuffer = framebuffer_;
  pass.renderArea.extent = {static_cast<std::uint32_t>(width()), static_cast<std::uint32_t>(height())};
  vkCmdBeginRenderPass(commands_, &pass, VK_SUBPASS_CONTENTS_INLINE);
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands_);
  vkCmdEndRenderPass(commands_);
  image_.change(commands_, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  if (after) after(commands_, image_);
  finish(wait, signal);
}

void Canvas::save(const std::filesystem::path& png) {
  const VkDeviceSize bytes = VkDeviceSize(4) * width() * height();
  VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  create.size = bytes;
  create.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const std::shared_ptr<void> freed(nullptr, [&](void*) {
    gpu_.waitUntilIdle();
    vkDestroyBuffer(gpu_.device, buffer, nullptr);
    vkFreeMemory(gpu_.device, memory, nullptr);
  });
  require(vkCreateBuffer(gpu_.device, &create, nullptr, &buffer), "saving the picture");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(gpu_.device, buffer, &needs);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = gpu_.memoryType(
      needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  require(vkAllocateMemory(gpu_.device, &allocate, nullptr, &memory), "saving the picture");
  require(vkBindBufferMemory(gpu_.device, buffer, memory, 0), "saving the picture");
  begin();
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {static_cast<std::uint32_t>(width()), static_cast<std::uint32_t>(height()), 1};
  vkCmdCopyImageToBuffer(commands_, image_.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1,
                         &region);
  VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host,
                       0, nullptr, 0, nullptr);
  finish(VK_NULL_HANDLE, VK_NULL_HANDLE);
  void* pixels = nullptr;
  require(vkMapMemory(gpu_.device, memory, 0, bytes, 0, &pixels), "saving the picture");
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(height(), width(), CV_8UC4, pixels), bgr, cv::COLOR_RGBA2BGR);
  std::vector<std::uint8_t> encoded;
  cv::imencode(".png", bgr, encoded);
  writeFileAtomically(png, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
}

}  // namespace rosefusion::viewer
