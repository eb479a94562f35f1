// Removes a lens' distortion from images, so that the pinhole model holds.
#pragma once
#include <opencv2/core.hpp>

#include "host/core/camera.h"

namespace rosefusion::datasets {

/// Brown's model with OpenCV's order of coefficients: radial k1 k2 k3, tangential p1 p2, and of the rational
/// model, which wide lenses need, k4 k5 k6.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;
  double centre_x = 0, centre_y = 0;  ///< about which it distorts, in focal lengths
  double xy_factor = 2;               ///< of p1 x y and p2 x y; 1 in Microsoft's Rational6KT
  double radius = 0;                  ///< focal lengths; the model holds up to there; 0: everywhere

  /// Where the lens images what the pinhole camera sees at (x, y); both in focal lengths from the centre. Not
  /// finite where the model does not hold.
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
