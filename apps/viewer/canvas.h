// The picture that is drawn: the pictures beneath, and ImGui's panels and lines on top. A window shows it, a
// screenshot keeps it; both are the same.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>

#include "apps/viewer/image.h"

namespace rosefusion::viewer {

/// Owns ImGui's renderer; ImGui's context must be there before and after. One thread.
class Canvas {
 public:
  explicit Canvas(Gpu& gpu);
  ~Canvas();

  void resize(int width, int height);
  int width() const { return image_.width(); }
  int height() const { return image_.height(); }

  /// One frame. `beneath` records the pictures into the canvas image, which is TRANSFER_DST meanwhile; then
  /// come ImGui's draw data; then `after`, with the image in TRANSFER_SRC. Waits for `wait` before `after`'s
  /// transfers and signals `signal`. Returns when the device is done.
  void draw(const std::function<void(VkCommandBuffer, VkImage)>& beneath,
            const std::function<void(VkCommandBuffer, const Image&)>& after = {},
            VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);
  /// Writes what was drawn last. Throws InputError when the file cannot be written.
  void save(const std::filesystem::path& png);

 private:
  // Where an exception ends the other constructor, the destructor cleans up.
  explicit Canvas(Gpu* gpu) : gpu_(*gpu) {}
  void begin();
  void finish(VkSemaphore wait, VkSemaphore signal);
  void destroyFramebuffer();

  Gpu& gpu_;
  Image image_;
  VkRenderPass render_pass_ = VK_NULL_HANDLE;
  VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
  VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence done_ = VK_NULL_HANDLE;
  bool has_panels_ = false;  ///< ImGui's backend was begun
};

}  // namespace rosefusion::viewer
