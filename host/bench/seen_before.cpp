#include "host/bench/seen_before.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {

void SeenBefore::add(const Frame& frame, const Pose& world_from_camera) {
  views_.push_back({frame.depth.clone(), world_from_camera.inverse()});
}

double SeenBefore::share(const Frame& frame, const Pose& world_from_camera) const {
  constexpr int kStride = 8;
  constexpr double kSame_m = 0.05;
  const auto depthAt = [&](const cv::Mat& image, int u, int v) {
    const auto value = image.at<std::uint16_t>(v, u);
    return value == 65535 ? 0.0 : value / units_;
  };
  int all = 0, seen = 0;
  for (int v = kStride / 2; v < frame.depth.rows; v += kStride)
    for (int u = kStride / 2; u < frame.depth.cols; u += kStride) {
      ++all;
      const double z = depthAt(frame.depth, u, v);
      if (z <= 0) continue;
      const Eigen::Vector3d world = world_from_camera * camera_.unproject(u, v, z);
      seen += std::any_of(views_.begin(), views_.end(), [&](const View& view) {
        const Eigen::Vector3d p = view.camera_from_world * world;
        if (p.z() <= 0) return false;
        const Eigen::Vector2d pixel = camera_.project(p);
        const double x = std::round(pixel.x()), y = std::round(pixel.y());
        return x >= 0 && y >= 0 && x < view.depth.cols && y < view.depth.rows &&
               std::abs(depthAt(view.depth, static_cast<int>(x), static_cast<int>(y)) - p.z()) < kSame_m;
      });
    }
  return all ? static_cast<double>(seen) / all : 0;
}

}  // namespace rosefusion
