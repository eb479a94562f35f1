// Tells when something that is not part of the scene comes before the camera, or a pose is wrong: there is a
// surface where an earlier image showed nothing.
#pragma once
#include <algorithm>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "host/core/camera.h"
#include "host/core/trajectory.h"
#include "host/settings/settings.h"

namespace rosefusion {

/// Remembers the last image, and 77 kB (of 640 x 480 pixels) of every one that shows the scene from
/// elsewhere. One thread.
class KnownFreeSpace {
 public:
  KnownFreeSpace(const Intrinsics& camera, const DepthSettings& range, double depth_units_per_metre)
      : camera_(camera), range_(range), units_(depth_units_per_metre) {}

  /// Keeps a depth image (as Frame::depth) of the static scene and its pose, to compare later ones with.
  /// `frame`: its number, for rebase().
  void keep(const cv::Mat& depth, const Pose& world_from_camera, std::size_t frame);
  /// After a correction of the map: every frame's pose, by its number.
  void rebase(std::span<const Pose> frame_poses);
  /// Share of the valid pixels (every 8th is looked at) whose surface lies in space that the last kept image
  /// saw to be empty. 0 before any is kept.
  double violationOfLast(const cv::Mat& depth, const Pose& world_from_camera) const;
  /// The same for all that was kept.
  double violation(const cv::Mat& depth, const Pose& world_from_camera) const;
  /// The other way round: of the surfaces in all that was kept and that should now be in view, the share that
  /// the image looks through. Small where the pose is right and the scene unchanged.
  double missingSurface(const cv::Mat& depth, const Pose& world_from_camera) const;

  /// Both together, of few pixels, for poses that may be off by some decimetres and degrees: for each of
  /// `places`, world_from_camera, how much speaks against it.
  std::vector<double> quickScore(const cv::Mat& depth, std::span<const Pose> places) const;

 private:
  struct View {
    cv::Mat depth;  ///< CV_32F metres of every 4th pixel; 0 where invalid
    Pose world_from_camera = Pose::Identity(), camera_from_world = Pose::Identity();
    std::size_t frame = 0;
  };
  View shrunk(const cv::Mat& depth, const Pose& world_from_camera) const;
  /// By so much, metres, depths of one surface may differ: one at z, and one that was seen there.
  double margin(double z, double seen) const;
  /// Whether the view shows a surface at this point; `scale` widens the margin.
  bool shows(const View& view, const Eigen::Vector3d& world, double scale = 1) const;
  double metresAt(const cv::Mat& depth, int u, int v) const;
  /// Whether the view shows nothing but surfaces well behind this point, a pixel of its own around.
  bool seesThrough(const View& view, const Eigen::Vector3d& world, double scale = 1) const;
  template <typename Test>
  double shareWhere(const cv::Mat& depth, const Pose& world_from_camera, int stride, const Test& test) const;
  double violation(const cv::Mat& depth, const Pose& world_from_camera, int stride, double margin) const;
  /// visit(point in the world) for every stride-th remembered pixel.
  template <typename Visit>
  void eachSurface(const View& view, int stride, const Visit& visit) const;
  /// Of surfaces that should be in view, those that the image looks through.
  struct Missing {
    int expected = 0, missing = 0;
    void look(const KnownFreeSpace& seen, const View& now, const Eigen::Vector3d& world, double margin);
    double share(int at_least) const { return static_cast<double>(missing) / std::max(expected, at_least); }
  };

  Intrinsics camera_;
  DepthSettings range_;
  double units_;
  View last_;
  std::vector<View> keyframes_;
};

}  // namespace rosefusion
