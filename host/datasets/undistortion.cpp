#include "host/datasets/undistortion.h"

#include <limits>
#include <opencv2/imgproc.hpp>

namespace rosefusion::datasets {

Eigen::Vector2d Distortion::apply(const Eigen::Vector2d& pinhole) const {
  const double x = pinhole.x() - centre_x, y = pinhole.y() - centre_y, r2 = x * x + y * y;
  const double below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  if ((radius > 0 && r2 > radius * radius) || below <= 0)
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / below;
  return {x * radial + xy_factor * p1 * x * y + p2 * (r2 + 2 * x * x) + centre_x,
          y * radial + p1 * (r2 + 2 * y * y) + xy_factor * p2 * x * y + centre_y};
}

Undistortion::Undistortion(const Distortion& distortion, const Intrinsics& k)
    : from_(k.height, k.width, CV_32FC2) {
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const Eigen::Vector2d at = distortion.apply({(u - k.cx) / k.fx, (v - k.cy) / k.fy});
      constexpr double kOutside = -100;  // of any image
      from_.at<cv::Vec2f>(v, u) = {static_cast<float>(at.allFinite() ? k.fx * at.x() + k.cx : kOutside),
                                   static_cast<float>(at.allFinite() ? k.fy * at.y() + k.cy : kOutside)};
    }
}

void Undistortion::undistortDepth(cv::Mat& depth) const {
  cv::Mat out;
  cv::remap(depth, out, from_, {}, cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
  depth = out;
}

void Undistortion::undistortColour(cv::Mat& bgr) const {
  cv::Mat out;
  cv::remap(bgr, out, from_, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  bgr = out;
}

}  // namespace rosefusion::datasets
