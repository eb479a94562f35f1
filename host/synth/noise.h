// The depth noise of a structured-light camera.
#pragma once
#include <opencv2/core/mat.hpp>

#include "host/synth/random.h"

namespace rosefusion {

/// Noise of Handa, Whelan, McDonald, Davison: A benchmark for RGB-D visual odometry, 3D reconstruction and
/// SLAM (ICRA 2014), after Barron and Malik (CVPR 2013). depth: CV_32FC1 in metres, 0 invalid; returns the
/// same.
///   1. Each pixel reads the depth at a place moved by N(0, 0.5 px) in u and v (bilinear; where one of the
///   four
///      neighbours is invalid, the nearest one).
///   2. d = 35130 / z_cm;  d' = round(d + N(0, 1/6) + 0.5);  z' = 35130 / d' cm.
/// Step 2 as published is biased: rounding is symmetric, so that the 0.5 stays and the mean disparity is d +
/// 0.5. Depth reads z^2 / 702.6 m too short (1.4 mm at 1 m, 5.7 mm at 2 m, 23 mm at 4 m; in the original the
/// 0.5 turned a floor() into rounding). Its standard deviation is z^2 / 351.3 m * sqrt(1/36 + 1/12):
/// 0.95, 3.8, 15 mm.
cv::Mat addHandaNoise(const cv::Mat& depth, Rng& rng);

}  // namespace rosefusion
