#include "apps/viewer/window.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"

namespace rosefusion::viewer {

Window::Window(int width, int height) {
  const char* reason = "GLFW gives no reason";
  const auto refuse = [&] {
    glfwGetError(&reason);
    throw DeviceError(DeviceErrorCode::NoDevice,
                      std::string("No window can be opened (") + (reason ? reason : "") +
                          "); use --headless with --screenshot where there is no display.");
  };
  if (!glfwInit()) refuse();
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ = glfwCreateWindow(width, height, "rosefusion", nullptr, nullptr);
  if (!window_) {
    glfwGetError(&reason);
    glfwTerminate();
    refuse();
  }
  glfwSetWindowSizeLimits(window_, 800, 600, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    self->dropped_.insert(self->dropped_.end(), paths, paths + count);
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    if (action == GLFW_PRESS && key >= 0)
      static_cast<Window*>(glfwGetWindowUserPointer(window))->pressed_.push_back(key);
  });
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::vector<const char*> Window::surfaceExtensions() const {
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names)
    throw DeviceError(DeviceErrorCode::NoDriver,
                      "The Vulkan driver cannot draw into windows; use --headless with --screenshot.");
  return {names, names + count};
}

VkSurfaceKHR Window::makeSurface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  require(glfwCreateWindowSurface(instance, window_, nullptr, &surface), "opening the window");
  return surface;
}

void Window::setTitle(const std::string& title) {
  if (title != title_) glfwSetWindowTitle(window_, title.c_str());
  title_ = title;
}

std::vector<std::string> Window::takeDropped() {
  return std::exchange(dropped_, {});
}

std::vector<int> Window::takePressed() {
  return std::exchange(pressed_, {});
}

Presenter::Presenter(Gpu& gpu, const Window& window) : gpu_(gpu), window_(window) {
  const VkSemaphoreCreateInfo create{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  require(vkCreateSemaphore(gpu.device, &create, nullptr, &acquired_), "opening the window");
}

Presenter::~Presenter() {
  destroyImages();
  if (swapchain_) vkDestroySwapchainKHR(gpu_.device, swapchain_, nullptr);
  vkDestroySemaphore(gpu_.device, acquired_, nullptr);
}

void Presenter::destroyImages() {
  {
    const std::lock_guard lock(gpu_.queue_mutex);
    vkQueueWaitIdle(gpu_.queue);
  }
  for (const VkSemaphore semaphore : drawn_) vkDestroySemaphore(gpu_.device, semaphore, nullptr);
  drawn_.clear();
  images_.clear();
}

void Presenter::makeImages(VkExtent2D extent) {
  destroyImages();
  VkSurfaceCapabilitiesKHR can;
  require(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(gpu_.physical, gpu_.surface, &can), "opening the window");
  if (!(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
    throw DeviceError(DeviceErrorCode::MissingLimit,
                      "This device's windows cannot be copied into; use --headless.");
  std::uint32_t count = 0;
  vkGetPhysicalDeviceSurfaceFormatsKHR(gpu_.physical, gpu_.surface, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  vkGetPhysicalDeviceSurfaceFormatsKHR(gpu_.physical, gpu_.surface, &count, formats.data());
  // The canvas is in sRGB already: an image that encodes once more would be too bright.
  const auto plain = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
  });
  const VkSurfaceFormatKHR format = plain != formats.end() ? *plain : formats.at(0);
  VkSwapchainCreateInfoKHR create{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  create.surface = gpu_.surface;
  create.minImageCount =
      can.maxImageCount ? std::min(can.minImageCount + 1, can.maxImageCount) : can.minImageCount + 1;
  create.imageFormat = format.format;
  create.imageColorSpace = format.colorSpace;
  create.imageExtent = {std::clamp(extent.width, can.minImageExtent.width, can.maxImageExtent.width),
                        std::clamp(extent.height, can.minImageExtent.height, can.maxImageExtent.height)};
  create.imageArrayLayers = 1;
  create.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  create.preTransform = can.currentTransform;
  create.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  if (!(can.supportedCompositeAlpha & create.compositeAlpha))
    create.compositeAlpha = VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  create.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  create.clipped = VK_TRUE;
  create.oldSwapchain = swapchain_;
  VkSwapchainKHR fresh = VK_NULL_HANDLE;
  require(vkCreateSwapchainKHR(gpu_.device, &create, nullptr, &fresh), "opening the window");
  if (swapchain_) vkDestroySwapchainKHR(gpu_.device, swapchain_, nullptr);
  swapchain_ = fresh;
  extent_ = create.imageExtent;
  vkGetSwapchainImagesKHR(gpu_.device, swapchain_, &count, nullptr);
  images_.resize(count);
  vkGetSwapchainImagesKHR(gpu_.device, swapchain_, &count, images_.data());
  drawn_.resize(count);
  const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  for (VkSemaphore& s : drawn_)
    require(vkCreateSemaphore(gpu_.device, &semaphore, nullptr, &s), "opening the window");
  outdated_ = false;
}

bool Presenter::fit(Canvas& canvas) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_.handle(), &width, &height);
  if (width <= 0 || height <= 0) return false;
  const VkExtent2D wanted{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  if (outdated_ || wanted.width != extent_.width || wanted.height != extent_.height) makeImages(wanted);
  canvas.resize(static_cast<int>(extent_.width), static_cast<int>(extent_.height));
  return true;
}

void Presenter::present(Canvas& canvas, const std::function<void(VkCommandBuffer, VkImage)>& beneath) {
  std::uint32_t index = 0;
  const VkResult acquired =
      vkAcquireNextImageKHR(gpu_.device, swapchain_, UINT64_MAX, acquired_, VK_NULL_HANDLE, &index);
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
    outdated_ = true;
    return canvas.draw(beneath);
  }
  require(acquired, "showing the picture");
  const auto show = [&](VkCommandBuffer commands, const Image& picture) {
    recordBarrier(commands, images_[index], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    recordScaled(commands, picture, images_[index],
                 {0, 0, static_cast<int>(extent_.width), static_cast<int>(extent_.height)});
    recordBarrier(commands, images_[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
  };
  canvas.draw(beneath, show, acquired_, drawn_[index]);
  VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = &drawn_[index];
  present.swapchainCount = 1;
  present.pSwapchains = &swapchain_;
  present.pImageIndices = &index;
  const std::lock_guard lock(gpu_.queue_mutex);
  const VkResult shown = vkQueuePresentKHR(gpu_.queue, &present);
  outdated_ = shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR;
  if (shown != VK_ERROR_OUT_OF_DATE_KHR) require(shown, "showing the picture");
}

}  // namespace rosefusion::viewer
