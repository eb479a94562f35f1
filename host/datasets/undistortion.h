// Removes a lens' distortion from images, so that the pinhole model holds.
#pragma once
#include <opencv2/core.hpp>

#include "host/core/camera.h"

namespace rosefusion::datasets {

/// Brown's model with OpenCV's order of coefficients: radial k1 k2 k3, tangential p1 p2.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;

  /// Where the lens images what the pinhole camera sees at (x, y); both in focal lengths from the centre.
  Eigen::Vector2d apply(const Eigen::Vector2d& pinhole) const;
  bool operator==(const Distortion&) const = default;
};

class Undistortion {
 public:
  Undistortion(const Distortion& distortion, const Intrinsics& intrinsics);

  /// The nearest pixel's depth: between two surfaces there is none. 0 where the lens saw nothing.
  void undistortDepth(cv::Mat& depth) const;
  void undistortColour(cv::Mat& bgr) const;

 private:
  cv::Mat from_;  ///< 2 x float: the distorted image's coordinates of each pixel
};

}  // namespace rosefusion::datasets
