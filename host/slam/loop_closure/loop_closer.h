// Recognises places that the camera comes back to, and takes out the drift that it brings along.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/passes/preprocess.h"
#include "host/core/camera.h"
#include "host/core/frame.h"
#include "host/settings/settings.h"
#include "host/swarm/template_sampling.h"

namespace rosefusion {

class Device;
class Volume;

/// A loop that was closed at a frame.
struct LoopClosure {
  double timestamp = 0;  ///< of the old keyframe that was recognised, seconds
  double shift = 0;      ///< by which the camera was corrected, metres
  double turn = 0;       ///< radians
};

/// Sums over a run.
struct LoopFigures {
  std::size_t keyframes = 0, keyframes_with_images = 0;
  std::uint64_t image_bytes = 0;   ///< on the host
  std::size_t checks = 0;          ///< keyframes compared with an old place
  std::size_t agreements = 0;      ///< of these, within loops.tolerance of where the camera was thought to be
  std::size_t closures = 0;        ///< loops that moved the map
  std::size_t contradictions = 0;  ///< closures taken back
};

/// Each new keyframe is compared with a small model, made of nothing but the images of an old keyframe and
/// its neighbours: what drift has done to the volume does not matter there. The Device must outlive it. One
/// thread.
class LoopCloser {
 public:
  virtual ~LoopCloser() = default;
  /// Tells of a frame that was accepted, and held by `on_device`; `metres`: its depth (depthInMetres());
  /// `well_constrained`: the depth held it in every direction. Where that closes a loop, all earlier poses
  /// have changed: the caller rebuilds its volume.
  virtual std::optional<LoopClosure> add(const Frame& frame, const cv::Mat& metres,
                                         const DeviceFrame& on_device, const Pose& world_from_camera,
                                         bool fused, bool well_constrained) = 0;
  /// The camera was lost.
  virtual void onTrackingLost() = 0;
  /// Closes with all that is known at the end of a run in which loops were closed. True where poses changed
  /// enough for the volume to be rebuilt.
  virtual bool finish() = 0;
  /// Empties the volume and fuses the stored keyframes into it. Throws DeviceError.
  virtual void rebuild(Volume& volume) = 0;
  /// Of all frames added, in their order, as known now.
  virtual std::vector<Pose> framePoses() const = 0;
  virtual LoopFigures figures() const = 0;
};

/// Throws InputError where this program was built without what it needs.
std::unique_ptr<LoopCloser> makeLoopCloser(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, double depth_units_per_metre,
                                           const TemplateSet& templates);

}  // namespace rosefusion
