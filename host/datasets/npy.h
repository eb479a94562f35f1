// NumPy's .npy files that hold one image.
#pragma once
#include <opencv2/core/mat.hpp>
#include <string_view>

namespace rosefusion::datasets {

bool isNpy(std::string_view bytes);

/// An array of rows x columns (x 1) of uint16, float32 or float64, row by row: CV_16UC1, CV_32FC1 or
/// CV_64FC1. Empty for anything else, and for one that is cut short.
cv::Mat decodedNpy(std::string_view bytes);

}  // namespace rosefusion::datasets
