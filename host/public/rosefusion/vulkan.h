// rosefusion inside a Vulkan application: on its device, in its command buffers, in its shaders.
//
// One queue. All that the library submits, and all command buffers that it recorded into, go to the queue of
// VulkanHandles; on it every command of the library is ordered after those submitted before by barriers that
// it records itself. To use its results on another queue, signal a semaphore from a submit of your own. What
// waits for the device says so; nothing else does. The Reconstructor's members that do work wait for its end.
#pragma once
#include <vulkan/vulkan_core.h>

#include <functional>

#include "rosefusion/reconstructor.h"

namespace rosefusion {

/// A Vulkan device that the caller made. All of it stays the caller's, must outlive every Reconstructor made
/// on it, and is neither destroyed nor waited for as a whole. No other instance, device or global state of
/// Vulkan is made or touched.
struct VulkanHandles {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  std::uint32_t api_version = VK_API_VERSION_1_1;  ///< VkApplicationInfo::apiVersion of the instance
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< of `queue_family`
  std::uint32_t queue_family = 0;
  const VkAllocationCallbacks* allocator = nullptr;  ///< copied; used for every object of the library's
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;   ///< null: the library has one of its own
  /// Called around every vkQueueSubmit of the library, on the thread that submits; never held while anything
  /// is waited for. Needed when other threads of the caller use the queue, or two Reconstructors share it.
  /// What lock_queue throws comes out of the call, which has then submitted nothing; unlock_queue may not
  /// throw.
  std::function<void()> lock_queue, unlock_queue;
};

/// What the instance and the device must have been made with. No feature and no extension beyond Vulkan 1.1.
struct VulkanRequirements {
  std::uint32_t api_version = VK_API_VERSION_1_1;
  VkQueueFlags queue_flags = VK_QUEUE_COMPUTE_BIT;
  VkPhysicalDeviceFeatures features{};                ///< all off
  std::vector<const char*> extensions_where_offered;  ///< to be enabled on devices that offer them
  /// To be enabled on the instance, with the flag, where the loader offers it: else it hides MoltenVK.
  const char* instance_extension_where_offered = nullptr;
  VkInstanceCreateFlags instance_flag_with_it = 0;
};
ROSEFUSION_API VulkanRequirements vulkanRequirements();

/// What stands in the way, one clause each, before a device is made: only get_instance_proc_addr, instance,
/// api_version, physical_device and queue_family are read. Empty when a Reconstructor can be made. Throws
/// Error (Misuse) for null among these. Any thread.
ROSEFUSION_API std::vector<std::string> missingFor(const VulkanHandles& handles);

/// Waited for before the first command of a frame, and signalled after its last, on the queue. `value` is
/// that of a timeline semaphore; 0 means a binary one. process() returns only after its commands have run,
/// so whatever signals `wait` must be under way by then. `signal` is signalled where the frame fails too, but
/// not for frames that were refused (BadInput, Misuse) or that the destructor drops.
struct Semaphores {
  struct Point {
    VkSemaphore semaphore = VK_NULL_HANDLE;
    std::uint64_t value = 0;
  };
  std::vector<Point> wait;
  std::vector<Point> signal;
};

/// From where a View looks.
struct Look {
  Matrix world_from_camera = kIdentity;
  float near = 0.05f;  ///< depths along the axis, metres
  float far = 8;
  bool colour = true;  ///< the volume's colours, where it has any
  bool clear = true;   ///< transparent black where nothing is hit; false: a dark backdrop
  /// (a, b, c, d): a hit at depth z gets the depth value a + b / z + c z, a pixel without one gets d. The
  /// default is metres, 0 where nothing is. For a projection that maps z to (A z + B) / z: {A, B, 0, clear
  /// value}; for Vulkan's usual one A = far / (far - near), B = -A near, clear value 1.
  std::array<float, 4> depth_value = {0, 0, 1, 0};
};

/// Images that a View fills from their upper left corner. Both need VK_IMAGE_USAGE_TRANSFER_DST_BIT, be at
/// least as large as the View's camera, and lie in `layout` (TRANSFER_DST_OPTIMAL or GENERAL) when the
/// commands run; they are in it afterwards. The writes are VK_ACCESS_TRANSFER_WRITE_BIT in
/// VK_PIPELINE_STAGE_TRANSFER_BIT: barriers on both sides are the caller's.
struct ViewImages {
  VkImage picture = VK_NULL_HANDLE;  ///< R8G8B8A8, UNORM or SRGB: the texels are sRGB. Null: not wanted
  VkImage depth = VK_NULL_HANDLE;    ///< R32_SFLOAT or, on a graphics queue, D32_SFLOAT. Null: not wanted
  VkImageAspectFlagBits depth_aspect = VK_IMAGE_ASPECT_COLOR_BIT;  ///< DEPTH_BIT for D32_SFLOAT
  VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
};

/// Draws the model into the caller's images, in the caller's command buffers.
///
/// Owns one set of device buffers for each command buffer that may be in flight (a slot). One thread at a
/// time, which need not be that of the Reconstructor: frames may be processed meanwhile, and the picture is
/// of the model after the last frame that was finished when record() was called. Must not outlive the
/// Reconstructor, and no slot may be in flight when it is destroyed.
class ROSEFUSION_API View {
 public:
  /// `camera`: size and intrinsics of the pictures. Builds the pipelines, which takes the driver a moment.
  /// Throws Error (BadInput, OutOfMemory).
  View(const Reconstructor& reconstructor, const Camera& camera, std::uint32_t slots = 2);
  ~View();
  View(View&&) noexcept;
  View& operator=(View&&) noexcept;

  /// Records into `commands`, a primary command buffer outside of a render pass. Never waits and submits
  /// nothing. Pipelines are built here, at most three times in all, when the model has outgrown another
  /// quarter of what it may become. What was recorded into the same slot before must have completed, or never
  /// be submitted. The model's memory that the commands read is kept until the slot is recorded anew. Throws
  /// Error: Misuse for a slot that is none, BadInput for a pose that is no rigid transform, OutOfMemory.
  void record(VkCommandBuffer commands, std::uint32_t slot, const Look& look, const ViewImages& images);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A depth image on the device, with the values of DepthFrame::depth, without colour. It is read by the
/// commands of Fusion::recordSearch(), with VK_ACCESS_TRANSFER_READ_BIT in VK_PIPELINE_STAGE_TRANSFER_BIT:
/// the barrier before is the caller's, and it may be overwritten after them. The host does not see it: where
/// tracking goes on, what comes before the camera is not noticed against this image.
struct DeviceDepth {
  VkBuffer buffer = VK_NULL_HANDLE;  ///< VK_BUFFER_USAGE_TRANSFER_SRC_BIT; row by row without gaps
  VkDeviceSize offset = 0;           ///< of the first pixel, bytes
  /// Where `buffer` is null: R16_UINT or R16_UNORM, VK_IMAGE_USAGE_TRANSFER_SRC_BIT, the camera's image in
  /// its upper left corner.
  VkImage image = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;  ///< or GENERAL
  double timestamp = 0;                                         ///< seconds, growing
};

/// Fuses frames of known pose in the caller's command buffers, in two steps: what the first finds decides on
/// the host how the model's memory grows, and the caller waits in between where it likes:
///
///     do {
///       fusion.recordSearch(commands, frame, pose);    // submit, and wait for it as you like
///     } while (fusion.grow());
///     fusion.recordFusion(commands);                   // submit
///
/// One thread at a time, and no frame of the Reconstructor may be processed from the first recordSearch()
/// until the last commands have completed. Of the members grow() alone waits for the device; grow() and
/// recordFusion() also wait for a mesh() on another thread. Tracking then goes on from the pose. Must not
/// outlive the Reconstructor, and no commands may be in flight when it is destroyed.
class ROSEFUSION_API Fusion {
 public:
  /// Builds pipelines, which takes the driver a moment. Throws Error: BadInput with loops.enabled, which
  /// moves poses; OutOfMemory.
  explicit Fusion(Reconstructor& reconstructor);
  ~Fusion();
  Fusion(Fusion&&) noexcept;
  Fusion& operator=(Fusion&&) noexcept;

  /// Records what finds out where the model needs memory for `frame`, whose images are copied; its motion is
  /// not read. `commands`: as of View::record(). The last commands of this object must have completed. Throws
  /// Error: BadInput for an image of another size or a pose that is no rigid transform, Misuse while pushed
  /// frames are waiting, OutOfMemory.
  void recordSearch(VkCommandBuffer commands, const DepthFrame& frame, const Matrix& world_from_camera);
  /// The same of a depth image on the device. Throws Error (Misuse) also where there is none.
  void recordSearch(VkCommandBuffer commands, const DeviceDepth& depth, const Matrix& world_from_camera);
  /// After these commands have completed: gives the model that memory. Where it needs some, submits copies to
  /// the queue and waits for them; else returns at once. True when the search must be recorded and run once
  /// more. Throws Error (OutOfMemory); the model is then as before.
  bool grow();
  /// Records the fusion of the frame searched for last; the model is whole once the commands have run, which
  /// they must. Pipelines are built here as in View::record(). Throws Error: Misuse where no frame was
  /// searched for since the last fusion, OutOfMemory.
  void recordFusion(VkCommandBuffer commands);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The model's buffers, for shaders that include lib/volume.glsl of the installed GLSL (CMake variable
/// rosefusion_GLSL_DIR). Storage buffers, owned by the library, kept alive by `hold`; after later frames they
/// show what was fused into the same blocks, and new ones only when asked for again. Access is ordered with
/// the library's own on its queue when it ends in a barrier from your stage to COMPUTE_SHADER and TRANSFER;
/// it may only read.
struct VolumeBuffers {
  VkBuffer layout = VK_NULL_HANDLE;  ///< VolumeLayout
  VkBuffer table = VK_NULL_HANDLE;   ///< page table
  VkBuffer blocks = VK_NULL_HANDLE;  ///< ivec4 block coordinate by slot
  std::array<VkBuffer, 4> tsdf{};    ///< pools; beyond `chunks` the first is repeated
  std::array<VkBuffer, 4> weight{};  ///< likewise
  std::array<VkBuffer, 4> colour{};  ///< likewise; without colour the TSDF's
  std::uint32_t chunks = 1;          ///< specialisation constant 0 of shaders that read the volume
  std::uint32_t block_count = 0;     ///< slots 1 to this
  std::shared_ptr<const void> hold;  ///< let go before the Reconstructor ends
};

/// Those of the model after the last frame that is finished. Any thread; never waits for a frame, and does
/// not fail.
ROSEFUSION_API VolumeBuffers volumeBuffers(const Reconstructor& reconstructor);

}  // namespace rosefusion
