// What the camera's past motion says about its next pose.
#pragma once
#include <optional>

#include "host/core/camera.h"

namespace rosefusion {

/// Constant velocity, linear in the world and angular about the camera's centre, from the last two poses.
class MotionModel {
 public:
  /// Timestamps must grow; a pose with an older one starts anew.
  void add(const Pose& world_from_camera, double timestamp);
  /// The last pose carried on; as it is where no velocity is known. Velocities fade when nothing was added
  /// for longer than `longest` seconds.
  Pose predict(double timestamp, double longest = 0.2) const;
  /// Of the camera that predict() carries on, in its own frame; none where it is not known.
  std::optional<Velocity> velocity() const;
  /// Since the last pose; infinite where there is none.
  double secondsSince(double timestamp) const;
  /// Whether frames seem to be missing before this time: it is far later than the last pose, by the time
  /// between the last two.
  bool isInterrupted(double timestamp) const;
  /// The world was corrected: where its poses are now.
  void rebase(const Pose& new_from_old_world);
  /// After a loss: the next pose makes no velocity with those before it.
  void forget() {
    before_.reset();
    last_.reset();
  }

 private:
  struct Stamped {
    Pose world_from_camera;
    double timestamp;
  };
  std::optional<Stamped> last_, before_;
};

}  // namespace rosefusion
