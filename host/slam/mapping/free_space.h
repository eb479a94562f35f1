// Tells when something that is not part of the scene comes before the camera, or a pose is wrong: there is a
// surface where an earlier image showed nothing.
#pragma once
#include <algorithm>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "host/core/camera.h"
#include "host/settings/settings.h"
#include "host/slam/mapping/keyframes.h"

namespace rosefusion {

/// Of the last image and of the keyframes', which must outlive it. Images (`depth`) are in metres, as of
/// depthInMetres(). One thread.
class KnownFreeSpace {
 public:
  KnownFreeSpace(const Intrinsics& camera, const DepthSettings& range, const Keyframes& keyframes)
      : camera_(camera), range_(range), keyframes_(keyframes) {}

  /// Share of the valid pixels (every 8th is looked at) whose surface lies in space that the last image
  /// saw to be empty. 0 before there is one.
  double violationOfLast(const cv::Mat& depth, const Pose& world_from_camera) const;
  /// The same of the keyframes.
  double violation(const cv::Mat& depth, const Pose& world_from_camera) const;
  /// The other way round: of the keyframes' surfaces that should now be in view, the share that
  /// the image looks through. Small where the pose is right and the scene unchanged.
  double missingSurface(const cv::Mat& depth, const Pose& world_from_camera) const;

  /// Both together, of few pixels, for poses that may be off by some decimetres and degrees: for each of
  /// `places`, world_from_camera, how much speaks against it.
  std::vector<double> quickScore(const cv::Mat& depth, std::span<const Pose> places) const;

 private:
  /// By so much, metres, depths of one surface may differ: one at z, and one that was seen there.
  double margin(double z, double seen) const;
  /// Whether the view shows a surface at this point; `scale` widens the margin.
  bool shows(const Keyframe& view, const Eigen::Vector3d& world, double scale = 1) const;
  /// Whether the view shows nothing but surfaces well behind this point, a pixel of its own around.
  bool seesThrough(const Keyframe& view, const Eigen::Vector3d& world, double scale = 1) const;
  template <typename Test>
  double shareWhere(const cv::Mat& depth, const Pose& world_from_camera, int stride, const Test& test) const;
  double violation(const cv::Mat& depth, const Pose& world_from_camera, int stride, double margin) const;
  /// visit(point in the world) for every stride-th remembered pixel.
  template <typename Visit>
  void eachSurface(const Keyframe& view, int stride, const Visit& visit) const;
  /// Of surfaces that should be in view, those that the image looks through.
  struct Missing {
    int expected = 0, missing = 0;
    void look(const KnownFreeSpace& seen, const Keyframe& now, const Eigen::Vector3d& world, double margin);
    double share(int at_least) const { return static_cast<double>(missing) / std::max(expected, at_least); }
  };

  Intrinsics camera_;
  DepthSettings range_;
  const Keyframes& keyframes_;
};

}  // namespace rosefusion
