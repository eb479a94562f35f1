// From where the model is looked at: around it, behind the camera, or through it.
#pragma once
#include "host/core/camera.h"

namespace rosefusion::viewer {

enum class ViewMode { Orbit, Follow, FirstPerson };
const char* toString(ViewMode mode);

/// Moves smoothly, whatever changes: mode, model or the tracked camera. Up is the first frame's (world -y).
/// Pure.
class ViewCamera {
 public:
  void setMode(ViewMode mode) { mode_ = mode; }
  ViewMode mode() const { return mode_; }

  /// Of the orbit, by what the mouse did. Angles in radians; `zoom` above 1 comes nearer; shares of the
  /// distance.
  void turn(double right, double down);
  void zoom(double factor);
  void pan(double right, double down);
  /// Looks at `centre` from such a distance that a sphere of `radius` (metres) is seen whole.
  void frame(const Eigen::Vector3d& centre, double radius);

  /// Moves on by `seconds` towards where the mode wants to be, with the tracked camera at `tracked`.
  void advance(const Pose& tracked, double seconds);
  /// The same without the way: for the first picture and without a display.
  void jump(const Pose& tracked);

  /// world_from_camera to draw with.
  const Pose& pose() const { return pose_; }
  /// Of a picture of this size; first-person has the tracked camera's angle of view.
  Intrinsics intrinsics(int width, int height, const Intrinsics& tracked) const;

 private:
  Pose goal(const Pose& tracked) const;

  ViewMode mode_ = ViewMode::Orbit;
  Eigen::Vector3d centre_{0, 0, 2};
  double azimuth_ = 0.5, elevation_ = 0.7, distance_ = 6;
  Pose pose_ = Pose::Identity();
};

}  // namespace rosefusion::viewer
