// The noise of a structured-light camera, and of a colour camera beside it.
#pragma once
#include <opencv2/core/mat.hpp>

#include "host/synth/random.h"

namespace rosefusion {

/// What makes a whole number of the noisy disparity d + n.
enum class DisparityRounding {
  Published,  ///< floor(d + n + 0.5): to the nearest, without bias
  Simkinect,  ///< round(d + n + 0.5): half a step too large
};

/// Noise of Handa, Whelan, McDonald, Davison: A benchmark for RGB-D visual odometry, 3D reconstruction and
/// SLAM (ICRA 2014), after Barron and Malik (CVPR 2013). depth: CV_32FC1 in metres, 0 invalid; returns the
/// same.
///   1. Each pixel reads the depth at a place moved by N(0, 0.5 px) in u and v (bilinear; where one of the
///      four neighbours is invalid, the nearest one).
///   2. d = 35130 / z_cm;  d' = floor(d + n + 0.5), n from N(0, 1/6);  z' = 35130 / d' cm.
/// Its standard deviation is z^2 / 351.3 m * sqrt(1/36 + 1/12): 0.95 mm at 1 m, 3.8 mm at 2 m, 15 mm at 4 m.
/// The program `simkinect` (A. Handa) rounds to the nearest after adding the 0.5, so that the mean disparity
/// is d + 0.5 and depth reads z^2 / 702.6 m too near: 1.4, 5.7, 23 mm. Simkinect is for comparisons with
/// data made by it; what else it does (depth in whole centimetres, holes from the dot pattern) is left out.
cv::Mat addHandaNoise(const cv::Mat& depth, Rng& rng,
                      DisparityRounding rounding = DisparityRounding::Published);

inline constexpr double kColourSigma = 2;  ///< of 255

/// Adds a camera's noise to a CV_8UC3 image: normal, each channel of each pixel by itself.
void addColourNoise(cv::Mat& colour, Rng& rng);

}  // namespace rosefusion
