// Depth in floating-point metres as the 16-bit units that everything behind the readers takes.
#pragma once
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rosefusion::datasets {

inline constexpr double kUnitsOfMetres = 5000;  ///< 0.2 mm, up to 13 m

/// 0, which is invalid, for NaN and for what does not fit.
inline std::uint16_t unitsOf(double metres) {
  const double units = std::round(metres * kUnitsOfMetres);
  return units > 0 && units < 65535 ? static_cast<std::uint16_t>(units) : 0;  // NaN is not > 0
}

/// CV_32FC1 of `per_metre` a metre to CV_16UC1 of kUnitsOfMetres a metre.
inline cv::Mat unitsOf(const cv::Mat& depth, double per_metre) {
  cv::Mat out(depth.size(), CV_16UC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      out.at<std::uint16_t>(v, u) = unitsOf(depth.at<float>(v, u) / per_metre);
  return out;
}

}  // namespace rosefusion::datasets
