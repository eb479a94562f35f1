// Structured light (RealSense F200): the projector's code is read on small windows, so that neighbours share
// their errors; where the projector's light does not come, or comes back too weak, there is no depth.
#include <cmath>
#include <opencv2/core.hpp>

#include "host/synth/depth_simulation.h"
#include "host/synth/infrared.h"

namespace rosefusion {
namespace {

constexpr double kLeastSignal = 0.3;      // of a white wall's at 1 m
constexpr double kCodeNoise = 0.08;       // pixels of disparity, at the signal of a white wall at 1 m
constexpr double kCodeNoiseFloor = 0.05;  // pixels
constexpr double kCodeSteps = 32;         // a pixel of disparity
constexpr int kWindowReach = 2;           // the window is 5 x 5
constexpr float kSameSurface = 1.5;       // pixels of disparity within a window
constexpr double kLeastShare = 0.55;      // of the window that must agree

}  // namespace

cv::Mat measureStructuredLight(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  const Intrinsics& k = sensor.depth;
  const Pose camera = pose_at(0);
  const double longest = 2 * sensor.farthest, scale = k.fx * sensor.baseline;
  const Eigen::Vector3d projector(sensor.baseline, 0, 0);
  const InfraredView view = viewInfrared(tracer, k, camera, longest);
  const ProjectorShadow shadow(tracer, camera * Eigen::Translation3d(projector), longest);

  cv::Mat disparity(k.height, k.width, CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      // Drawn for every pixel, so that one that is lost does not change all after it.
      const double strength = 1 + 0.2 * rng.normal(), error = rng.normal();
      const double z = view.depth.at<float>(v, u);
      if (z <= 0 || !shadow.isLit(k.unproject(u, v, z) - projector)) continue;
      const double signal = view.albedo.at<float>(v, u) * view.facing.at<float>(v, u) / (z * z);
      if (signal * strength < kLeastSignal) continue;
      disparity.at<float>(v, u) =
          static_cast<float>(scale / z + error * std::hypot(kCodeNoiseFloor, kCodeNoise / signal));
    }

  const cv::Mat read = meanOfLike(disparity, kWindowReach, kSameSurface, kLeastShare);
  cv::Mat depth(k.height, k.width, CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (const float d = read.at<float>(v, u); d > 0)
        depth.at<float>(v, u) = static_cast<float>(scale * kCodeSteps / std::round(kCodeSteps * d));
  return depth;
}

}  // namespace rosefusion
