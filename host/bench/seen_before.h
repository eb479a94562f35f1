// How much of a depth image shows what other images showed: what a lost tracker could find its way by.
#pragma once
#include <vector>

#include "host/core/camera.h"
#include "host/core/frame.h"
#include "host/core/trajectory.h"

namespace rosefusion {

class SeenBefore {
 public:
  SeenBefore(const Intrinsics& camera, double depth_units_per_metre)
      : camera_(camera), units_(depth_units_per_metre) {}
  void add(const Frame& frame, const Pose& world_from_camera);
  /// Share of the image, invalid pixels included, whose surface lies within 5 cm of one that was added; every
  /// 8th pixel is looked at.
  double share(const Frame& frame, const Pose& world_from_camera) const;

 private:
  struct View {
    cv::Mat depth;
    Pose camera_from_world;
  };
  Intrinsics camera_;
  double units_;
  std::vector<View> views_;
};

}  // namespace rosefusion
