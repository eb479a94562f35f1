// What keyframes saw, coarsely: which old one looks at what the newest sees. Pure: no device, no full images.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

/// One thread.
class KeyframeViews {
 public:
  explicit KeyframeViews(const Intrinsics& camera) : camera_(camera) {}

  /// Numbers keyframes in the order in which they come; `metres`: as of depthInMetres().
  void add(const cv::Mat& metres);
  /// Share of what keyframe `newest` saw that keyframe `old` saw too, from about as far, when it looked along
  /// old_from_newest. That may be off by as much as tracking drifts between two visits.
  double overlap(std::size_t newest, std::size_t old, const Pose& old_from_newest) const;

 private:
  struct View {
    cv::Mat depth;                        ///< CV_32F, metres; 0 where there is none
    std::vector<Eigen::Vector3f> points;  ///< in the camera
  };

  Intrinsics camera_;
  std::vector<View> views_;
};

}  // namespace rosefusion
