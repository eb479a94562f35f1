#include "host/synth/noise.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr double kDisparityCm = 35130;  // disparity units times centimetres
constexpr double kJitterPixels = 0.5;
constexpr double kDisparitySigma = 1.0 / 6;

double sampleDepth(const cv::Mat& depth, double u, double v) {
  u = std::clamp(u, 0.0, depth.cols - 1.0);
  v = std::clamp(v, 0.0, depth.rows - 1.0);
  const int u0 = std::min(static_cast<int>(u), depth.cols - 2),
            v0 = std::min(static_cast<int>(v), depth.rows - 2);
  const double a = u - u0, b = v - v0;
  const float *top = depth.ptr<float>(v0) + u0, *bottom = depth.ptr<float>(v0 + 1) + u0;
  if (top[0] <= 0 || top[1] <= 0 || bottom[0] <= 0 || bottom[1] <= 0)
    return (b < 0.5 ? top : bottom)[a < 0.5 ? 0 : 1];
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

double wholeDisparity(double disparity, DisparityRounding rounding) {
  return rounding == DisparityRounding::Published ? std::floor(disparity + 0.5) : std::round(disparity + 0.5);
}

}  // namespace

cv::Mat addHandaNoise(const cv::Mat& depth, Rng& rng, DisparityRounding rounding) {
  cv::Mat noisy(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      // Drawn for every pixel, so that one invalid pixel does not change all noise after it.
      const double du = kJitterPixels * rng.normal(), dv = kJitterPixels * rng.normal();
      const double error = kDisparitySigma * rng.normal();
      const double z = sampleDepth(depth, u + du, v + dv);
      const double disparity = z > 0 ? wholeDisparity(kDisparityCm / (z * 100) + error, rounding) : 0;
      noisy.at<float>(v, u) = disparity > 0 ? static_cast<float>(kDisparityCm / disparity / 100) : 0.0f;
    }
  return noisy;
}

void addColourNoise(cv::Mat& colour, Rng& rng) {
  for (int v = 0; v < colour.rows; ++v)
    for (int u = 0; u < colour.cols; ++u)
      for (std::uint8_t& channel : colour.at<cv::Vec3b>(v, u).val)
        channel = cv::saturate_cast<std::uint8_t>(channel + kColourSigma * rng.normal());
}

}  // namespace rosefusion
