// What differs between the releases of Dear ImGui: 1.86 (Debian 12), 1.90 (Debian 13), 1.92 (Debian testing).
#pragma once
#include <imgui.h>

#include <functional>
#include <vector>

#include "apps/viewer/gpu.h"

struct GLFWwindow;

namespace rosefusion::viewer {

/// Whether this capital letter, digit or space went down.
bool isPressed(char key);

/// Keys (GLFW's numbers) that went down since the last frame count as down in the next one, also those that
/// are up again: a frame may take longer than a tap. From 1.87 on ImGui keeps such taps, and these do
/// nothing.
void holdKeys(const std::vector<int>& keys);
void releaseKeys(const std::vector<int>& keys, GLFWwindow* window);

/// The size that a font was added with.
float sizeOf(const ImFont& font);
/// Until ImGui::PopFont().
void pushFont(ImFont& font);

/// Calls a function with a command buffer, and returns when the device has run what was recorded.
using RecordAndRun = std::function<void(const std::function<void(VkCommandBuffer)>&)>;
/// How many textures ImGui's renderer wants of its descriptor pool.
std::uint32_t textureCount();
void startRenderer(Gpu& gpu, VkRenderPass pass, VkDescriptorPool descriptors, const RecordAndRun& record);
/// Makes the textures that the frame's draw data need, before those are recorded.
void updateTextures(Gpu& gpu);

}  // namespace rosefusion::viewer
