// Stands in where GLFW was not found.
#include <stdexcept>

#include "apps/renderer/window.h"

namespace renderer {

struct Window::Impl {};

std::vector<const char*> windowExtensions() {
  throw std::runtime_error(
      "This renderer was built without GLFW; install libglfw3-dev and build again, or use --out.");
}
Window::Window(Application&, VkExtent2D) {
  windowExtensions();
}
Window::~Window() = default;
bool Window::closed() {
  return true;
}
void Window::present(VkCommandBuffer, VkImage) {}

}  // namespace renderer
