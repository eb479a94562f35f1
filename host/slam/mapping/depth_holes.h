// Small holes of a depth image, for what the host reads of it pixel by pixel.
#pragma once
#include <opencv2/core/mat.hpp>

namespace rosefusion {

/// A copy of `depth` (as Frame::depth) in which a pixel without depth (0 or 65535) has the mean of two valid
/// ones that lie opposite each other, at most 2 pixels away, on what may be one surface. An image registered
/// to a larger colour image has a grid of such holes. Nothing is filled at the border of what was seen.
cv::Mat withSmallHolesFilled(const cv::Mat& depth);

}  // namespace rosefusion
