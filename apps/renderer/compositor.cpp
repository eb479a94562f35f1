#include "apps/renderer/compositor.h"

#include <cstring>

namespace renderer {
namespace {

constexpr float kNear = 0.05f, kFar = 50;                                     // metres
constexpr float kDepthA = kFar / (kFar - kNear), kDepthB = -kNear * kDepthA;  // depth value = A + B / z
constexpr std::uint32_t kVertexCode[] = {
#include "scene.vert.inc"
};
constexpr std::uint32_t kFragmentCode[] = {
#include "scene.frag.inc"
};
constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                          VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kColourAccess =
    VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

/// Column-major. A pixel's centre has integer coordinates in the camera, and .5 in Vulkan's viewport.
std::array<float, 16> clipFromWorld(const rosefusion::Camera& k,
                                    const rosefusion::Matrix& world_from_camera) {
  const double x = 2 * k.fx / k.width, y = 2 * k.fy / k.height;
  const double shift_x = 2 * (k.cx + 0.5) / k.width - 1, shift_y = 2 * (k.cy + 0.5) / k.height - 1;
  const auto& m = world_from_camera;
  std::array<float, 16> out;
  for (int column = 0; column < 4; ++column) {
    double camera[3];  // of camera_from_world, which is the transpose of a rotation
    for (int row = 0; row < 3; ++row)
      camera[row] = column < 3 ? m[4 * row + column]
                               : -(m[4 * row] * m[12] + m[4 * row + 1] * m[13] + m[4 * row + 2] * m[14]);
    const double z = camera[2], one = column == 3;
    out[4 * column] = static_cast<float>(x * camera[0] + shift_x * z);
    out[4 * column + 1] = static_cast<float>(y * camera[1] + shift_y * z);
    out[4 * column + 2] = static_cast<float>(kDepthA * z + kDepthB * one);
    out[4 * column + 3] = static_cast<float>(z);
  }
  return out;
}

}  // namespace

Compositor::Compositor(Application& application, const rosefusion::Reconstructor& reconstructor,
                       const rosefusion::Camera& camera, const std::vector<Vertex>& triangles)
    : application_(application),
      camera_(camera),
      size_{static_cast<std::uint32_t>(camera.width), static_cast<std::uint32_t>(camera.height)},
      view_(reconstructor, camera, 1),
      colour_(application.makeImage(VK_FORMAT_R8G8B8A8_UNORM,
                                    VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                    VK_IMAGE_ASPECT_COLOR_BIT, size_)),
      depth_(application.makeImage(
          VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
          VK_IMAGE_ASPECT_DEPTH_BIT, size_)),
      vertices_(
          application.makeHostBuffer(sizeof(Vertex) * triangles.size(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT)),
      readback_(
          application.makeHostBuffer(4ull * size_.width * size_.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT)),
      vertex_count_(static_cast<std::uint32_t>(triangles.size())) {
  std::memcpy(vertices_.mapped, triangles.data(), sizeof(Vertex) * triangles.size());
  makePass();
  makePipeline();
}

Compositor::~Compositor() {
  application_.waitForFrame();
  const VkDevice device = application_.device;
  vkDestroyPipeline(device, pipeline_, nullptr);
  vkDestroyPipelineLayout(device, layout_, nullptr);
  vkDestroyFramebuffer(device, framebuffer_, nullptr);
  vkDestroyRenderPass(device, pass_, nullptr);
  application_.destroy(readback_);
  application_.destroy(vertices_);
  application_.destroy(depth_);
  application_.destroy(colour_);
}

void Compositor::makePass() {
  VkAttachmentDescription attachments[2]{};
  for (auto& attachment : attachments) {
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;  // what rosefusion drew
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  }
  attachments[0].format = VK_FORMAT_R8G8B8A8_UNORM;
  attachments[0].initialLayout = attachments[0].finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachments[1].format = VK_FORMAT_D32_SFLOAT;
  attachments[1].initialLayout = attachments[1].finalLayout =
      VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pDepthStencilAttachment = &depth;
  VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  info.attachmentCount = 2;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  require(vkCreateRenderPass(application_.device, &info, nullptr, &pass_), "Making a render pass");
  const VkImageView views[] = {colour_.view, depth_.view};
  VkFramebufferCreateInfo framebuffer{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  framebuffer.renderPass = pass_;
  framebuffer.attachmentCount = 2;
  framebuffer.pAttachments = views;
  framebuffer.width = size_.width;
  framebuffer.height = size_.height;
  framebuffer.layers = 1;
  require(vkCreateFramebuffer(application_.device, &framebuffer, nullptr, &framebuffer_),
          "Making a framebuffer");
}

void Compositor::makePipeline() {
  const VkDevice device = application_.device;
  const auto makeModule = [&](const std::uint32_t* words, std::size_t bytes) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = bytes;
    info.pCode = words;
    VkShaderModule made = VK_NULL_HANDLE;
    require(vkCreateShaderModule(device, &info, nullptr, &made), "Making a shader");
    return made;
  };
  const VkShaderModule modules[] = {makeModule(kVertexCode, sizeof kVertexCode),
                                    makeModule(kFragmentCode, sizeof kFragmentCode)};
  VkPipelineShaderStageCreateInfo stages[2]{};
  for (int i = 0; i < 2; ++i) {
    stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stages[i].stage = i == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[i].module = modules[i];
    stages[i].pName = "main";
  }
  const VkVertexInputBindingDescription binding{0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX};
  const VkVertexInputAttributeDescription attributes[] = {
      {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
      {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, colour)}};
  VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  input.vertexBindingDescriptionCount = 1;
  input.pVertexBindingDescriptions = &binding;
  input.vertexAttributeDescriptionCount = 2;
  input.pVertexAttributeDescriptions = attributes;
  VkPipelineInputAssemblyStateCreateInfo assembly{
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const VkViewport viewport{0, 0, float(size_.width), float(size_.height), 0, 1};
  const VkRect2D scissor{{0, 0}, size_};
  VkPipelineViewportStateCreateInfo view{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  view.viewportCount = view.scissorCount = 1;
  view.pViewports = &viewport;
  view.pScissors = &scissor;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.cullMode = VK_CULL_MODE_NONE;
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                          VK_COLOR_COMPONENT_A_BIT;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &opaque;
  const VkPushConstantRange push{VK_SHADER_STAGE_VERTEX_BIT, 0, 64};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  require(vkCreatePipelineLayout(device, &layout, nullptr, &layout_), "Making a pipeline");
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &view;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.layout = layout_;
  info.renderPass = pass_;
  require(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
          "Making a pipeline");
  for (const VkShaderModule module : modules) vkDestroyShaderModule(device, module, nullptr);
}

void Compositor::draw(VkCommandBuffer commands, const rosefusion::Matrix& world_from_camera) {
  // What the images held is drawn over; only its last uses must be over.
  transition(commands, colour_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
             VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
  transition(commands, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kDrawing, 0, VK_PIPELINE_STAGE_TRANSFER_BIT,
             VK_ACCESS_TRANSFER_WRITE_BIT);
  rosefusion::Look look;
  look.world_from_camera = world_from_camera;
  look.clear = false;
  look.depth_value = {kDepthA, kDepthB, 0, 1};
  view_.record(commands, 0, look, {colour_.image, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT});
  transition(commands, colour_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
             VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
             VK_ACCESS_TRANSFER_WRITE_BIT, kDrawing, kColourAccess);
  transition(commands, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
             VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
             VK_ACCESS_TRANSFER_WRITE_BIT, kDrawing, kDepthAccess);

  VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  begin.renderPass = pass_;
  begin.framebuffer = framebuffer_;
  begin.renderArea = {{0, 0}, size_};
  vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  const auto matrix = clipFromWorld(camera_, world_from_camera);
  vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT, 0, 64, matrix.data());
  const VkDeviceSize start = 0;
  vkCmdBindVertexBuffers(commands, 0, 1, &vertices_.buffer, &start);
  vkCmdDraw(commands, vertex_count_, 1, 0, 0);
  vkCmdEndRenderPass(commands);

  transition(commands, colour_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kDrawing, kColourAccess, VK_PIPELINE_STAGE_TRANSFER_BIT,
             VK_ACCESS_TRANSFER_READ_BIT);
  const VkBufferImageCopy whole{
      0, 0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {0, 0, 0}, {size_.width, size_.height, 1}};
  vkCmdCopyImageToBuffer(commands, colour_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_.buffer, 1,
                         &whole);
  VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host,
                       0, nullptr, 0, nullptr);
}

}  // namespace renderer
