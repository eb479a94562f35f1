// How useful a view is for tracking, judged from a few rays.
#pragma once
#include "host/core/camera.h"
#include "host/synth/tracer.h"

namespace rosefusion {

struct ViewQuality {
  double valid = 0;       ///< share of rays that meet a surface within the largest depth
  double near = 0;        ///< share of rays that meet one closer than 0.4 m
  double median = 0;      ///< metres, of the valid rays
  double constraint = 0;  ///< smallest eigenvalue of the mean of n n^T over the valid rays: 0 for one flat
                          ///< wall, at most 1/3; how firmly point-to-plane alignment holds the translation
  bool isAcceptable() const { return valid > 0.75 && near < 0.15 && median > 0.7 && constraint > 0.01; }
  double score() const;  ///< larger is better
};

ViewQuality judgeView(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                      double max_depth);

}  // namespace rosefusion
