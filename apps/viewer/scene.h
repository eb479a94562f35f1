// The pictures beneath the panels: the surface as the view camera sees it, and the depth image.
#pragma once
#include <chrono>
#include <memory>
#include <optional>

#include "apps/viewer/image.h"
#include "apps/viewer/session.h"
#include "engine/passes/raycast.h"

namespace rosefusion::viewer {

/// Casts rays when the view or the model changed, at most so often and so finely that tracking and window go
/// on; the full resolution follows once nothing moves. Nothing is read back.
class Scene {
 public:
  Scene(Gpu& gpu, Device& device);

  /// Records what has changed. `area`: where the surface will be shown; `view`: from where, in the area's
  /// pixels; `finest`: at full resolution now.
  void record(VkCommandBuffer commands, const Snapshot& snapshot, const Pose& world_from_view,
              const Intrinsics& view, bool finest);
  /// Copies the pictures into the canvas.
  void place(VkCommandBuffer commands, VkImage canvas, const Rectangle& surface, const Rectangle& depth);
  /// Whether the picture is coarser than it could be, or older than the model.
  bool isProvisional() const { return provisional_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Caster {
    Intrinsics camera;
    std::unique_ptr<RaycastPass> pass;
    Image image;
  };
  Caster& casterFor(const Intrinsics& camera);
  void recordDepth(VkCommandBuffer commands, const Snapshot& snapshot);

  Gpu& gpu_;
  Device& device_;
  double coarse_pixels_;  ///< of a cast that must not take long; a GPU casts all of them in a moment
  Recorder recorder_;
  std::shared_ptr<RaycastKernels> kernels_;
  Caster coarse_, fine_;
  Caster* shown_ = nullptr;
  Pose shown_pose_ = Pose::Identity();
  Intrinsics shown_view_;
  std::uint64_t shown_model_ = 0, shown_generation_ = 0, shown_depth_ = 0;
  Clock::time_point last_cast_{}, last_move_{};
  bool provisional_ = false;
  Buffer depth_pixels_;
  Image depth_;
};

}  // namespace rosefusion::viewer
