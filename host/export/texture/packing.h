// Rectangles side by side.
#pragma once
#include <opencv2/core/types.hpp>
#include <vector>

namespace rosefusion {

/// Gives each rectangle its place in an area; false where they do not fit.
bool packed(std::vector<cv::Rect>& rectangles, int width, int height);

/// Whether this build can.
bool packingAvailable();

}  // namespace rosefusion
