#include "apps/renderer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <stdexcept>

namespace renderer {
namespace {

void requireGlfw() {
  if (!glfwInit() || !glfwVulkanSupported())
    throw std::runtime_error("There is no window system with Vulkan here; use --out.");
}

}  // namespace

std::vector<const char*> windowExtensions() {
  requireGlfw();
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names) throw std::runtime_error("There is no window system with Vulkan here; use --out.");
  return {names, names + count};
}

struct Window::Impl {
  Application& application;
  VkExtent2D size{};    // of the picture
  VkExtent2D extent{};  // of the window's images
  GLFWwindow* window = nullptr;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain = VK_NULL_HANDLE;
  std::vector<VkImage> images;
  VkSemaphore acquired = VK_NULL_HANDLE;
  std::vector<VkSemaphore>
      drawn;  // one per image: presenting one may still be waiting when the next is drawn

  VkSemaphore makeSemaphore() const {
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore made = VK_NULL_HANDLE;
    require(vkCreateSemaphore(application.device, &info, nullptr, &made), "Making a semaphore");
    return made;
  }
  void makeSwapchain();
};

void Window::Impl::makeSwapchain() {
  VkBool32 supported = VK_FALSE;
  require(vkGetPhysicalDeviceSurfaceSupportKHR(application.physical, application.family, surface, &supported),
          "Asking for a surface");
  if (!supported) throw std::runtime_error("The device cannot present to this window; use --out.");
  VkSurfaceCapabilitiesKHR can;
  require(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(application.physical, surface, &can),
          "Asking for a surface");
  std::uint32_t count = 0;
  vkGetPhysicalDeviceSurfaceFormatsKHR(application.physical, surface, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  vkGetPhysicalDeviceSurfaceFormatsKHR(application.physical, surface, &count, formats.data());
  const auto plain = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
  });
  const VkSurfaceFormatKHR format = plain == formats.end() ? formats.at(0) : *plain;
  extent = can.currentExtent.width == ~0u ? size : can.currentExtent;
  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface;
  info.minImageCount = can.minImageCount;
  info.imageFormat = format.format;
  info.imageColorSpace = format.colorSpace;
  info.imageExtent = extent;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  require(vkCreateSwapchainKHR(application.device, &info, nullptr, &swapchain), "Making a swapchain");
  vkGetSwapchainImagesKHR(application.device, swapchain, &count, nullptr);
  images.resize(count);
  vkGetSwapchainImagesKHR(application.device, swapchain, &count, images.data());
}

Window::Window(Application& application, VkExtent2D size) : impl_(new Impl{application}) {
  requireGlfw();
  impl_->size = size;
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
  impl_->window = glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), "rosefusion",
                                   nullptr, nullptr);
  if (!impl_->window) throw std::runtime_error("The window cannot be opened; use --out.");
  require(glfwCreateWindowSurface(application.instance, impl_->window, nullptr, &impl_->surface),
          "Making a surface");
  impl_->makeSwapchain();
  impl_->acquired = impl_->makeSemaphore();
  for (std::size_t i = 0; i < impl_->images.size(); ++i) impl_->drawn.push_back(impl_->makeSemaphore());
}

Window::~Window() {
  Impl& d = *impl_;
  d.application.waitForFrame();
  {
    const auto lock = d.application.lockQueue();
    vkQueueWaitIdle(d.application.queue);  // for what is being presented
  }
  for (const VkSemaphore semaphore : d.drawn) vkDestroySemaphore(d.application.device, semaphore, nullptr);
  vkDestroySemaphore(d.application.device, d.acquired, nullptr);
  vkDestroySwapchainKHR(d.application.device, d.swapchain, nullptr);
  vkDestroySurfaceKHR(d.application.instance, d.surface, nullptr);
  glfwDestroyWindow(d.window);
  glfwTerminate();
}

bool Window::closed() {
  glfwPollEvents();
  return glfwWindowShouldClose(impl_->window);
}

void Window::present(VkCommandBuffer commands, VkImage picture) {
  Impl& d = *impl_;
  std::uint32_t index = 0;
  require(vkAcquireNextImageKHR(d.application.device, d.swapchain, ~0ull, d.acquired, VK_NULL_HANDLE, &index),
          "Drawing to the window");
  const VkImage image = d.images[index];
  transition(commands, image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
             VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
  VkImageBlit blit{};
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {static_cast<int>(d.size.width), static_cast<int>(d.size.height), 1};
  blit.dstOffsets[1] = {static_cast<int>(d.extent.width), static_cast<int>(d.extent.height), 1};
  vkCmdBlitImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image,
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
  transition(commands, image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
             VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
             VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0);
  d.application.endFrame(d.acquired, d.drawn[index]);
  VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &d.drawn[index];
  info.swapchainCount = 1;
  info.pSwapchains = &d.swapchain;
  info.pImageIndices = &index;
  const auto lock = d.application.lockQueue();
  require(vkQueuePresentKHR(d.application.queue, &info), "Drawing to the window");
}

}  // namespace renderer
