#include "host/synth/depth_simulation.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

namespace rosefusion {
namespace {

cv::Mat measureDepth(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  switch (sensor.principle) {
    case DepthPrinciple::Stereo:
      return measureStereo(sensor, tracer, pose_at, rng);
    case DepthPrinciple::StructuredLight:
      return measureStructuredLight(sensor, tracer, pose_at, rng);
    case DepthPrinciple::TimeOfFlight:
      return measureTimeOfFlight(sensor, tracer, pose_at, rng);
    case DepthPrinciple::PhoneLidar:
      return measurePhoneLidar(sensor, tracer, pose_at, rng);
    case DepthPrinciple::Noise:
      break;
  }
  throw std::logic_error("kinect1 is simulated by addHandaNoise.");
}

}  // namespace

cv::Mat registerDepth(const cv::Mat& depth, const Intrinsics& from, const Intrinsics& to,
                      const Pose& to_from_from, Registration registration) {
  if (registration == Registration::None) return depth;
  cv::Mat registered(to.height, to.width, CV_32FC1, cv::Scalar(0));
  const double half = registration == Registration::Areas ? 0.5 : 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double z = depth.at<float>(v, u);
      if (z <= 0) continue;
      const Eigen::Vector3d low = to_from_from * from.unproject(u - half, v - half, z),
                            high = to_from_from * from.unproject(u + half, v + half, z);
      if (low.z() <= 0 || high.z() <= 0) continue;
      const Eigen::Vector2d a = to.project(low), b = to.project(high);
      const auto carried = static_cast<float>((low.z() + high.z()) / 2);
      for (int y = std::max(0, int(std::floor(a.y() + 0.5)));
           y <= std::min(to.height - 1, int(std::floor(b.y() + 0.5))); ++y)
        for (int x = std::max(0, int(std::floor(a.x() + 0.5)));
             x <= std::min(to.width - 1, int(std::floor(b.x() + 0.5))); ++x) {
          float& there = registered.at<float>(y, x);
          if (there <= 0 || carried < there) there = carried;
        }
    }
  return registered;
}

cv::Mat simulateDepth(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  cv::Mat depth = registerDepth(measureDepth(sensor, tracer, pose_at, rng), sensor.depth, sensor.output(),
                                sensor.outputFromDepth(), sensor.registration);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      float& z = depth.at<float>(v, u);
      z = z >= sensor.nearest && z <= sensor.farthest ? std::round(z * 1000) / 1000 : 0.0f;
    }
  return depth;
}

}  // namespace rosefusion
