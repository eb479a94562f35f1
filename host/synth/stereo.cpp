// Stereo with a projected pattern (RealSense D400): both infrared views are rendered and matched, so that
// holes, shadows beside edges, fattened edges and noise that neighbours share come by themselves.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "host/synth/depth_simulation.h"
#include "host/synth/infrared.h"

namespace rosefusion {
namespace {

constexpr double kProjectorAt = 0.029;  // metres from the left camera
constexpr double kDotsAtOneMetre = 3;   // brightness of a dot against a room's light
constexpr double kMeanLevel = 70;       // of 255, what the exposure aims at
constexpr double kElectronsPerLevel = 40;
constexpr double kStereoReadNoise = 0.8;  // levels
constexpr int kSmoothReach = 4;           // pixels: what real recordings err by is that smooth
constexpr double kStereoSteps = 32;       // a pixel of disparity, as the camera sends it
constexpr int kDisparities = 128;
constexpr double kStereoFar = 30;

/// Light on each pixel, before exposure; a room's light is 1. The projector stands at (projector_at, 0, 0).
cv::Mat lightOf(const Tracer& tracer, const Intrinsics& k, const Pose& camera, double projector_at,
                const ProjectorShadow& shadow) {
  const InfraredView view = viewInfrared(tracer, k, camera, kStereoFar);
  cv::Mat light(view.depth.size(), CV_32FC1);
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      const double z = view.depth.at<float>(v, u);
      double sum = view.daylight.at<float>(v, u);
      const Eigen::Vector3d p = k.unproject(u, v, z) - Eigen::Vector3d(projector_at, 0, 0);
      if (z > 0)
        if (const float dot = dotPattern(p.x() / z, p.y() / z); dot > 0.02f && shadow.isLit(p))
          sum += kDotsAtOneMetre * dot * view.facing.at<float>(v, u) / (z * z);
      light.at<float>(v, u) = static_cast<float>(sum * view.albedo.at<float>(v, u));
    }
  return light;
}

/// 8 bit, with shot and read noise, and a dark margin on the left for the matcher.
cv::Mat exposed(const cv::Mat& light, double levels, Rng& rng) {
  cv::Mat image(light.rows, light.cols + kDisparities, CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      const double level = levels * light.at<float>(v, u);
      const double sigma = std::sqrt(level / kElectronsPerLevel + kStereoReadNoise * kStereoReadNoise);
      image.at<std::uint8_t>(v, u + kDisparities) =
          cv::saturate_cast<std::uint8_t>(level + sigma * rng.normal());
    }
  return image;
}

/// Parts of a pixel as cameras find them, without the matcher's steps: least squares of the brightness over
/// small windows (Lucas and Kanade 1981), from the matcher's disparities on. Takes those that no texture
/// holds.
void refine(cv::Mat& disparity, const cv::Mat& left, const cv::Mat& right) {
  constexpr int kIterations = 5, kWindow = 9;
  constexpr double kOutlier = 12;        // levels
  constexpr double kLeastTexture = 150;  // squared levels a pixel, summed over the window
  cv::Mat smooth, product(disparity.size(), CV_32FC1), square(disparity.size(), CV_32FC1);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    cv::medianBlur(disparity, smooth, 5);
    for (int v = 0; v < disparity.rows; ++v) {
      const std::uint8_t *l = left.ptr(v), *r = right.ptr(v);
      for (int u = 0; u < disparity.cols; ++u) {
        float &p = product.at<float>(v, u) = 0, &s = square.at<float>(v, u) = 0;
        const double x = u - smooth.at<float>(v, u);
        const int i = static_cast<int>(x);
        if (disparity.at<float>(v, u) <= 0 || smooth.at<float>(v, u) <= 0 || i < 1 || i + 2 >= disparity.cols)
          continue;
        // Cubic through four pixels (Catmull and Rom), and its slope.
        const double t = x - i, a = r[i - 1], b = r[i], c = r[i + 1], d = r[i + 2];
        const double one = (c - a) / 2, two = a - 2.5 * b + 2 * c - d / 2,
                     three = (d - a) / 2 + 1.5 * (b - c);
        const double error = l[u] - (b + t * (one + t * (two + t * three))),
                     slope = one + t * (2 * two + t * 3 * three);
        const double weight = 1 / (1 + error * error / (kOutlier * kOutlier));
        p = static_cast<float>(weight * slope * error);
        s = static_cast<float>(weight * slope * slope);
      }
    }
    for (cv::Mat* sum : {&product, &square})
      cv::boxFilter(*sum, *sum, -1, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
    for (int v = 0; v < disparity.rows; ++v)
      for (int u = 0; u < disparity.cols; ++u) {
        float& d = disparity.at<float>(v, u);
        if (d <= 0 || smooth.at<float>(v, u) <= 0) continue;
        const float texture = square.at<float>(v, u);
        d = texture < kLeastTexture
                ? 0.0f
                : smooth.at<float>(v, u) - std::clamp(product.at<float>(v, u) / texture, -0.5f, 0.5f);
      }
  }
}

}  // namespace

cv::Mat measureStereo(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  const Intrinsics& k = sensor.depth;
  const Pose left = pose_at(0);
  const auto beside = [&](double x) -> Pose { return left * Eigen::Translation3d(x, 0, 0); };
  const ProjectorShadow shadow(tracer, beside(kProjectorAt), kStereoFar);
  const cv::Mat left_light = lightOf(tracer, k, left, kProjectorAt, shadow),
                right_light =
                    lightOf(tracer, k, beside(sensor.baseline), kProjectorAt - sensor.baseline, shadow);
  const double levels = kMeanLevel / std::max(0.02, cv::mean(left_light)[0]);
  const cv::Mat left_image = exposed(left_light, levels, rng),
                right_image = exposed(right_light, levels, rng);

  constexpr int kBlock = 5;
  const auto matcher =
      cv::StereoSGBM::create(0, kDisparities, kBlock, 4 * kBlock * kBlock, 24 * kBlock * kBlock, 1, 31, 8,
                             100, 1, cv::StereoSGBM::MODE_SGBM_3WAY);
  cv::Mat whole, disparity;
  matcher->compute(left_image, right_image, whole);
  whole.convertTo(disparity, CV_32FC1, 1.0 / int{cv::StereoMatcher::DISP_SCALE});
  refine(disparity, left_image, right_image);
  disparity = meanOfLike(disparity, kSmoothReach, 1, 0);

  cv::Mat depth(k.height, k.width, CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const double d = std::round(kStereoSteps * disparity.at<float>(v, u + kDisparities)) / kStereoSteps;
      if (d > 0 && d <= u) depth.at<float>(v, u) = static_cast<float>(k.fx * sensor.baseline / d);
    }
  return depth;
}

}  // namespace rosefusion
