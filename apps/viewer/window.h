// The window, and how the canvas gets into it.
#pragma once
#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

#include <string>
#include <vector>

#include "apps/viewer/canvas.h"

namespace rosefusion::viewer {

/// GLFW and one window. Made before the Gpu, which makes its surface.
class Window {
 public:
  /// Throws DeviceError (NoDevice) without a display.
  Window(int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  std::vector<const char*> surfaceExtensions() const;
  VkSurfaceKHR makeSurface(VkInstance instance) const;
  GLFWwindow* handle() const { return window_; }
  bool wantsToClose() const { return glfwWindowShouldClose(window_) != 0; }
  /// What the window is called; nothing happens where it is called that already.
  void setTitle(const std::string& title);
  /// Folders and files that were dragged in since the last call.
  std::vector<std::string> takeDropped();
  /// Keys that went down since the last call, also those that are up again: a frame may take longer than a
  /// tap.
  std::vector<int> takePressed();

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<std::string> dropped_;
  std::vector<int> pressed_;
  std::string title_;
};

/// The window's images, made again whenever its size changes. One thread.
class Presenter {
 public:
  Presenter(Gpu& gpu, const Window& window);
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Resizes the canvas to the window. False while the window has no area, as when it is minimised.
  bool fit(Canvas& canvas);
  /// Draws the canvas and shows it.
  void present(Canvas& canvas, const std::function<void(VkCommandBuffer, VkImage)>& beneath);

 private:
  void destroyImages();
  void makeImages(VkExtent2D extent);

  Gpu& gpu_;
  const Window& window_;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  std::vector<VkImage> images_;
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  std::vector<VkSemaphore> drawn_;  ///< one per image: the screen may still wait for the last one
  bool outdated_ = true;
};

}  // namespace rosefusion::viewer
