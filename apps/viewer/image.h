// An image on the device with its memory and view, and the layouts it goes through.
#pragma once
#include "apps/viewer/gpu.h"

namespace rosefusion::viewer {

/// RGBA, 8 bits each, never sRGB-decoded. Must not outlive its Gpu.
class Image {
 public:
  Image() = default;
  Image(Gpu& gpu, int width, int height, VkImageUsageFlags usage);
  ~Image();
  Image(Image&& other) noexcept { *this = std::move(other); }
  Image& operator=(Image&& other) noexcept;

  /// Records the change to `layout`; with `discard` what the image held is lost.
  void change(VkCommandBuffer commands, VkImageLayout layout, bool discard = false);
  /// Tells that something else, such as a render pass, left it in `layout`.
  void isNow(VkImageLayout layout) { layout_ = layout; }

  int width() const { return width_; }
  int height() const { return height_; }
  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }

 private:
  Gpu* gpu_ = nullptr;
  int width_ = 0, height_ = 0;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VkImageLayout layout_ = VK_IMAGE_LAYOUT_UNDEFINED;
};

inline constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM;

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

void recordBarrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to);
/// Scales all of `from` (TRANSFER_SRC) into `to_area` of `to` (TRANSFER_DST).
void recordScaled(VkCommandBuffer commands, const Image& from, VkImage to, const Rectangle& to_area);

}  // namespace rosefusion::viewer
