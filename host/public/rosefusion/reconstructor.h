// rosefusion as a library: depth images in, camera poses and a mesh out. The Vulkan side is in
// rosefusion/vulkan.h.
#pragma once
#include <memory>
#include <optional>

#include "rosefusion/types.h"
#include "rosefusion/version.h"

namespace rosefusion {

struct VulkanHandles;  // rosefusion/vulkan.h
struct Semaphores;

/// Follows one camera and builds one model. Owns the model and, unless handles are given, a Vulkan device of
/// its own; several may live in one process, on one device or on several.
///
/// Threads: every member may be called from any thread. process(), integrate() and mesh() do their work on
/// the calling thread, one at a time: each waits for the others and for a pushed frame under way. push(),
/// poll(), trajectory() and blockCount() never wait for a frame. The constructor builds pipelines, submits
/// what makes the model's first memory and waits for that; and it generates the swarm's templates when this
/// user has none of these sizes yet (some 10 s, kept in $XDG_CACHE_HOME or ~/.cache).
///
/// Processes: std::exit() waits for the frame under way, and one that still lives then, in a static variable
/// too, is ended like any other. After fork() the child may make new ones, and must then end by _exit() (as
/// Python's multiprocessing does), for Mesa's drivers wait in exit() for threads that it has not. What the
/// parent made it cannot use (Error, Misuse); destroying that does nothing there.
class ROSEFUSION_API Reconstructor {
 public:
  /// On a Vulkan device of its own. Throws Error: BadInput for a camera or settings that cannot be, NoDevice,
  /// OutOfMemory.
  explicit Reconstructor(const Camera& camera, const Options& options = {});
  /// On the caller's device; see VulkanHandles for what stays whose. Options::device is not read. Throws
  /// Error, MissingLimit naming all that the device lacks, before any work is done on it.
  Reconstructor(const Camera& camera, const VulkanHandles& handles, const Options& options = {});
  /// Waits for the frame under way; frames that still wait in the queue are dropped.
  ~Reconstructor();
  Reconstructor(Reconstructor&&) noexcept;
  Reconstructor& operator=(Reconstructor&&) noexcept;

  /// Tracks and fuses one frame, and returns when that is done on the device. A lost frame is a result, not
  /// an error, and is not fused. `semaphores`: see rosefusion/vulkan.h; null: none. Throws Error: BadInput
  /// for an image of another size, OutOfMemory, DeviceLost, Misuse while pushed frames are waiting.
  Result process(const DepthFrame& frame, const Semaphores* semaphores = nullptr);
  /// Fuses one frame at a pose that the caller knows, and returns when that is done on the device; tracking
  /// goes on from there. Throws as process(), and BadInput for a pose that is no rigid transform and with
  /// loops.enabled, which moves poses.
  void integrate(const DepthFrame& frame, const Matrix& world_from_camera);

  /// Hands a frame to a thread of the Reconstructor's own, which processes the frames in their order; the
  /// images are copied. False when Options::queue_length frames are waiting: this one was then not taken.
  /// Throws Error (BadInput) for an image of another size.
  bool push(const DepthFrame& frame, const Semaphores* semaphores = nullptr);
  /// The result of the earliest pushed frame that was not polled yet, empty while there is none. Where
  /// processing that frame failed, its Error is thrown instead.
  std::optional<Result> poll();
  /// Returns when all pushed frames are processed; their results wait for poll().
  void wait();

  /// The model's surface now, as settings mesh.* say. Empty before the first fused frame. Throws Error
  /// (OutOfMemory, DeviceLost).
  Mesh mesh();
  /// Poses of all frames that were not lost, in their order. What was told may become better known: a frame
  /// that was lost when it came has its pose once later ones confirm it, one whose depth left a direction
  /// open is corrected once the camera is held again, and loops.enabled corrects all.
  std::vector<TimedPose> trajectory() const;
  /// Voxel blocks of the model after the last frame.
  std::size_t blockCount() const;
  /// Value of a setting as text. Throws Error (BadInput), with the nearest key, for one that is none.
  std::string setting(const std::string& key) const;
  /// Name of the Vulkan device.
  std::string device() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosefusion
