// What a lost camera is looked for in from afar: a coarse model of the scene, whose surfaces draw poses in
// from further away than the model's own, and the directions they face.
#pragma once
#include "host/frame_fuser.h"
#include "host/surface_directions.h"

namespace rosefusion {

/// One thread; the Device must outlive it.
class Overview {
 public:
  Overview(Device& device, const Settings& settings, const Intrinsics& camera, double depth_units_per_metre);

  /// Adds the frame (see Frame::depth) that `fuser` holds, at its pose.
  void add(FrameFuser& fuser, Recorder& recorder, const cv::Mat& depth, const Pose& world_from_camera);
  /// Voxels and truncation are several times those of the model proper. No colour.
  const Volume& volume() const { return volume_; }
  /// To be made anew after a correction of the map, whose turns are too small to change the directions.
  Volume& volume() { return volume_; }
  /// How the camera may be turned for its image to face what is known: world_from_camera, likeliest first.
  std::vector<Eigen::Matrix3d> rotationsOf(const cv::Mat& depth) const;

 private:
  cv::Mat metresOf(const cv::Mat& depth) const;

  Intrinsics camera_;
  DepthSettings range_;
  double units_;
  Volume volume_;
  std::vector<Eigen::Vector3d> normals_;  ///< in the world, some of each frame
};

}  // namespace rosefusion
