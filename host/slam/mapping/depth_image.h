// What the host reads of a depth image.
#pragma once
#include <opencv2/core/mat.hpp>

#include "host/settings/settings.h"

namespace rosefusion {

/// The depths of an image (as Frame::depth) in metres: CV_32F, 0 where there is none or it is out of the
/// settings' range. With depth.footprint its small holes are filled (depth_holes.h).
cv::Mat depthInMetres(const cv::Mat& depth, const DepthSettings& settings, double depth_units_per_metre);

}  // namespace rosefusion
