// A phone's LiDAR: some 500 points, spread over the image along the edges of the colour image, so that depth
// is smooth, without holes, and knows nothing smaller than the points' spacing.
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "host/synth/depth_simulation.h"
#include "host/synth/renderer.h"

namespace rosefusion {
namespace {

constexpr int kPointsAcross = 24, kPointsDown = 24;
constexpr double kPointNoiseFloor = 0.003, kPointNoiseShare = 0.004;  // metres, of the depth
constexpr double kPointReach = 1.9, kPointSpread = 0.6;               // of the points' spacing
constexpr double kColourSpread = 14;                                  // of 255

struct LidarPoint {
  double u, v, depth;
  cv::Vec3b colour;
};

std::vector<LidarPoint> measurePoints(const Sensor& sensor, const Tracer& tracer, const Pose& camera,
                                      const cv::Mat& colour, Rng& rng) {
  const Intrinsics& k = sensor.depth;
  std::vector<LidarPoint> points;
  for (int row = 0; row < kPointsDown; ++row)
    for (int column = 0; column < kPointsAcross; ++column) {
      // Every second row is moved by half a step, as the lasers stand.
      const double u = (column + 0.25 + 0.5 * (row % 2)) * k.width / kPointsAcross - 0.5,
                   v = (row + 0.5) * k.height / kPointsDown - 0.5, error = rng.normal();
      const auto hit =
          tracer.cast(camera.translation(), camera.linear() * k.unproject(u, v, 1), sensor.farthest);
      if (!hit) continue;
      points.push_back(
          {u, v, hit->distance + error * std::hypot(kPointNoiseFloor, kPointNoiseShare * hit->distance),
           colour.at<cv::Vec3b>(int(std::lround(v)), int(std::lround(u)))});
    }
  return points;
}

}  // namespace

cv::Mat measurePhoneLidar(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  const Intrinsics& k = sensor.depth;
  const Pose camera = pose_at(0);
  const cv::Mat colour = renderColour(tracer, k, camera);
  const double step_u = double(k.width) / kPointsAcross, step_v = double(k.height) / kPointsDown;
  cv::Mat sums(k.height, k.width, CV_32FC1, cv::Scalar(0)), weights = sums.clone();
  for (const LidarPoint& p : measurePoints(sensor, tracer, camera, colour, rng))
    for (int v = std::max(0, int(p.v - kPointReach * step_v));
         v <= std::min(k.height - 1.0, p.v + kPointReach * step_v); ++v)
      for (int u = std::max(0, int(p.u - kPointReach * step_u));
           u <= std::min(k.width - 1.0, p.u + kPointReach * step_u); ++u) {
        const double x = (u - p.u) / step_u, y = (v - p.v) / step_v;
        const double unlike =
            cv::norm(cv::Vec3d(colour.at<cv::Vec3b>(v, u)) - cv::Vec3d(p.colour)) / kColourSpread;
        // The second term keeps every pixel with some point, whatever its colour.
        const double weight = std::exp(-(x * x + y * y) / (2 * kPointSpread * kPointSpread)) *
                              (std::exp(-unlike * unlike / 2) + 0.003);
        sums.at<float>(v, u) += static_cast<float>(weight * p.depth);
        weights.at<float>(v, u) += static_cast<float>(weight);
      }
  cv::Mat depth(k.height, k.width, CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (const float weight = weights.at<float>(v, u); weight > 1e-6f)
        depth.at<float>(v, u) = sums.at<float>(v, u) / weight;
  return depth;
}

}  // namespace rosefusion
