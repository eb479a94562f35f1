#include "apps/viewer/image.h"

#include <utility>

namespace rosefusion::viewer {

Image::Image(Gpu& gpu, int width, int height, VkImageUsageFlags usage) : Image() {
  gpu_ = &gpu;
  width_ = width;
  height_ = height;
  VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = kFormat;
  create.extent = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 1};
  create.mipLevels = create.arrayLayers = 1;
  create.samples = VK_SAMPLE_COUNT_1_BIT;
  create.usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  require(vkCreateImage(gpu.device, &create, nullptr, &image_), "making an image");
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(gpu.device, image_, &needs);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = gpu.memoryType(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  require(vkAllocateMemory(gpu.device, &allocate, nullptr, &memory_), "making room for an image");
  require(vkBindImageMemory(gpu.device, image_, memory_, 0), "making an image");
  if (!(usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)) return;
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = image_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = kFormat;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  require(vkCreateImageView(gpu.device, &view, nullptr, &view_), "making an image");
}

Image::~Image() {
  if (!gpu_) return;
  if (view_) vkDestroyImageView(gpu_->device, view_, nullptr);
  vkDestroyImage(gpu_->device, image_, nullptr);
  vkFreeMemory(gpu_->device, memory_, nullptr);
}

Image& Image::operator=(Image&& other) noexcept {
  std::swap(gpu_, other.gpu_);
  std::swap(width_, other.width_);
  std::swap(height_, other.height_);
  std::swap(image_, other.image_);
  std::swap(memory_, other.memory_);
  std::swap(view_, other.view_);
  std::swap(layout_, other.layout_);
  return *this;
}

void Image::change(VkCommandBuffer commands, VkImageLayout layout, bool discard) {
  recordBarrier(commands, image_, discard ? VK_IMAGE_LAYOUT_UNDEFINED : layout_, layout);
  layout_ = layout;
}

void recordBarrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                       nullptr, 0, nullptr, 1, &barrier);
}

void recordScaled(VkCommandBuffer commands, const Image& from, VkImage to, const Rectangle& to_area) {
  VkImageBlit blit{};
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {from.width(), from.height(), 1};
  blit.dstOffsets[0] = {to_area.x, to_area.y, 0};
  blit.dstOffsets[1] = {to_area.x + to_area.width, to_area.y + to_area.height, 1};
  vkCmdBlitImage(commands, from.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
}

}  // namespace rosefusion::viewer
