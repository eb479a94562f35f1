// What a lost camera is looked for in from afar: a coarse model of the scene, whose surfaces draw poses in
// from further away than the model's own, and where they lie and face.
#pragma once
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/mapping/surface_patches.h"

namespace rosefusion {

/// One thread; the Device must outlive it.
class CoarseMap {
 public:
  CoarseMap(Device& device, const Settings& settings, const Intrinsics& camera, double depth_units_per_metre);

  /// Adds the frame (see Frame::depth) that `fuser` holds, at its pose. `frame`: its number, for rebase().
  void add(FrameIntegrator& fuser, Recorder& recorder, const cv::Mat& depth, const Pose& world_from_camera,
           std::size_t frame);
  /// Voxels and truncation are several times those of the model proper. No colour.
  const Volume& volume() const { return volume_; }
  void clear();
  /// To be made anew by the caller after rebase().
  Volume& volume() { return volume_; }
  /// After a correction of the map: every frame's pose, by its number.
  void rebase(std::span<const Pose> frame_poses);
  /// Of all frames added, in the world.
  const std::vector<SurfacePatch>& patches() const { return patches_; }
  /// Of a depth image (see Frame::depth), in the camera's frame.
  std::vector<SurfacePatch> patchesOf(const cv::Mat& depth) const;

 private:
  struct View {
    std::vector<SurfacePatch> patches;  ///< in the camera's frame
    std::size_t frame;
  };
  void place(const View& view, const Pose& world_from_camera);
  cv::Mat metresOf(const cv::Mat& depth) const;

  Intrinsics camera_;
  DepthSettings range_;
  double units_;
  Volume volume_;
  std::vector<View> views_;
  std::vector<SurfacePatch> patches_;  ///< of all views, in the world
};

}  // namespace rosefusion
