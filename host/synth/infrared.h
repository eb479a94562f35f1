// What an infrared camera beside a lamp or projector sees of a scene.
#pragma once
#include <opencv2/core/mat.hpp>

#include "host/core/camera.h"
#include "host/synth/random.h"
#include "host/synth/tracer.h"

namespace rosefusion {

/// Images of one size, CV_32FC1.
struct InfraredView {
  cv::Mat depth;     ///< metres along the optical axis; 0: nothing there
  cv::Mat albedo;    ///< 0 to 1
  cv::Mat facing;    ///< cosine between the surface's normal and the ray
  cv::Mat daylight;  ///< what other lamps shed on the surface, about 1
};

InfraredView viewInfrared(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                          double longest);

/// What a projector's light reaches. Half its field of view: tangents 1.07 by 0.8.
class ProjectorShadow {
 public:
  ProjectorShadow(const Tracer& tracer, const Pose& world_from_projector, double longest);
  bool isLit(const Eigen::Vector3d& point) const;  ///< in the projector's frame

 private:
  cv::Mat depth_;
};

/// Each valid value with those of the window around it, (2 reach + 1)^2 pixels, that differ from it by at
/// most `like`: their mean, as CV_32FC1; 0 where less than `least_share` of the window is such. 0 is invalid.
cv::Mat meanOfLike(const cv::Mat& disparity, int reach, float like, double least_share);

/// A constant field of pseudo-random dots, 0 to 1, over the tangents of a projector's rays.
float dotPattern(double tangent_x, double tangent_y);

}  // namespace rosefusion
