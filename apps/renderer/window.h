// The picture in a window, where the renderer is built with GLFW.
#pragma once
#include <memory>

#include "apps/renderer/application.h"

namespace renderer {

/// What the instance must be made with. Throws std::runtime_error where there is no window system or no GLFW.
std::vector<const char*> windowExtensions();

/// One thread, which must be the first one.
class Window {
 public:
  Window(Application& application, VkExtent2D size);
  ~Window();
  bool closed();
  /// Ends the frame: blits `picture`, in TRANSFER_SRC_OPTIMAL, into the window, submits and presents.
  void present(VkCommandBuffer commands, VkImage picture);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace renderer
