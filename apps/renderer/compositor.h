// One picture of two things: the live model, which rosefusion draws first, colour and depth, and the
// application's triangles, which the GPU then draws over it with its ordinary depth test.
#pragma once
#include <array>
#include <memory>

#include "apps/renderer/application.h"

namespace renderer {

/// World frame, metres; colour in sRGB, 0 to 1.
struct Vertex {
  std::array<float, 3> position;
  std::array<float, 3> colour;
};

/// Owns the images that it draws into. One thread; the Application and the Reconstructor must outlive it.
class Compositor {
 public:
  /// `camera`: size and intrinsics of the pictures. `triangles`: three vertices each.
  Compositor(Application& application, const rosefusion::Reconstructor& reconstructor,
             const rosefusion::Camera& camera, const std::vector<Vertex>& triangles);
  ~Compositor();
  Compositor(const Compositor&) = delete;

  /// Records one picture; it ends in picture(), in TRANSFER_SRC_OPTIMAL, as does a copy for read().
  void draw(VkCommandBuffer commands, const rosefusion::Matrix& world_from_camera);
  /// R8G8B8A8_UNORM.
  VkImage picture() const { return colour_.image; }
  VkExtent2D size() const { return size_; }
  /// The last picture, red in the low byte, row by row; after Application::waitForFrame().
  const std::uint32_t* read() const { return static_cast<const std::uint32_t*>(readback_.mapped); }

 private:
  void makePass();
  void makePipeline();

  Application& application_;
  rosefusion::Camera camera_;
  VkExtent2D size_;
  rosefusion::View view_;
  Image colour_, depth_;
  HostBuffer vertices_, readback_;
  std::uint32_t vertex_count_;
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace renderer
