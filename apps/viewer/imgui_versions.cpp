#include "apps/viewer/imgui_versions.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_vulkan.h>

namespace rosefusion::viewer {
namespace {

void check(VkResult result) {
  require(result, "drawing the panels");
}

// Templates, because only they may name a member that is not there.
template <typename Info>
void initialise(Info init, VkRenderPass pass) {
  if constexpr (requires { init.ApiVersion; }) init.ApiVersion = VK_API_VERSION_1_1;  // the instance's
  if constexpr (requires { init.PipelineInfoMain; }) {
    init.PipelineInfoMain.RenderPass = pass;
    init.PipelineInfoMain.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    ImGui_ImplVulkan_Init(&init);
  } else {
    init.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    if constexpr (requires { init.RenderPass; }) {
      init.RenderPass = pass;
      ImGui_ImplVulkan_Init(&init);
    } else {
      ImGui_ImplVulkan_Init(&init, pass);
    }
  }
}

template <typename Font>
float addedSize(const Font& font) {
  if constexpr (requires { font.LegacySize; })
    return font.LegacySize;
  else
    return font.FontSize;
}

}  // namespace

#if IMGUI_VERSION_NUM >= 18700

bool isPressed(char key) {
  int code = ImGuiKey_A + (key - 'A');
  if (key == ' ') code = ImGuiKey_Space;
  if (key >= '0' && key <= '9') code = ImGuiKey_0 + (key - '0');
  return ImGui::IsKeyPressed(static_cast<ImGuiKey>(code), false);
}

void holdKeys(const std::vector<int>&) {}
void releaseKeys(const std::vector<int>&, GLFWwindow*) {}

#else

namespace {
void heedControl() {
  ImGuiIO& io = ImGui::GetIO();
  io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
}
}  // namespace

// Keys have GLFW's numbers, which for these are their characters.
bool isPressed(char key) {
  return ImGui::IsKeyPressed(key, false);
}

void holdKeys(const std::vector<int>& keys) {
  for (const int key : keys) ImGui::GetIO().KeysDown[key] = true;
  heedControl();
}

void releaseKeys(const std::vector<int>& keys, GLFWwindow* window) {
  for (const int key : keys) ImGui::GetIO().KeysDown[key] = glfwGetKey(window, key) == GLFW_PRESS;
  heedControl();
}

#endif

float sizeOf(const ImFont& font) {
  return addedSize(font);
}

void pushFont(ImFont& font) {
#if IMGUI_VERSION_NUM >= 19200
  ImGui::PushFont(&font, sizeOf(font));
#else
  ImGui::PushFont(&font);
#endif
}

std::uint32_t textureCount() {
#ifdef IMGUI_IMPL_VULKAN_MINIMUM_IMAGE_SAMPLER_POOL_SIZE
  return IMGUI_IMPL_VULKAN_MINIMUM_IMAGE_SAMPLER_POOL_SIZE;
#else
  return 1;                                     // the font's
#endif
}

void startRenderer(Gpu& gpu, VkRenderPass pass, VkDescriptorPool descriptors,
                   [[maybe_unused]] const RecordAndRun& record) {
  ImGui_ImplVulkan_InitInfo init{};
  init.Instance = gpu.instance;
  init.PhysicalDevice = gpu.physical;
  init.Device = gpu.device;
  init.QueueFamily = gpu.queue_family;
  init.Queue = gpu.queue;
  init.DescriptorPool = descriptors;
  init.MinImageCount = init.ImageCount = 2;
  init.CheckVkResultFn = check;
  initialise(init, pass);
#if IMGUI_VERSION_NUM >= 19200
  // Its textures come and go with the frames.
#elif IMGUI_VERSION_NUM >= 19000
  const std::lock_guard lock(gpu.queue_mutex);  // it submits and waits by itself
  ImGui_ImplVulkan_CreateFontsTexture();
#else
  record([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
#endif
}

void updateTextures([[maybe_unused]] Gpu& gpu) {
#if IMGUI_VERSION_NUM >= 19200
  const ImVector<ImTextureData*>* textures = ImGui::GetDrawData()->Textures;
  if (!textures) return;
  const std::lock_guard lock(gpu.queue_mutex);  // it submits and waits by itself
  for (ImTextureData* texture : *textures)
    if (texture->Status != ImTextureStatus_OK) ImGui_ImplVulkan_UpdateTexture(texture);
#endif
}

}  // namespace rosefusion::viewer
