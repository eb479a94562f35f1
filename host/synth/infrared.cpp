#include "host/synth/infrared.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "host/synth/cast_image.h"
#include "host/synth/renderer.h"

namespace rosefusion {
namespace {

constexpr Intrinsics kProjector{640, 480, 300, 300, 319.5, 239.5};  // of the map of its shadows
constexpr double kHalfWidth = 1.06, kHalfHeight = 0.8;              // tangents
constexpr double kTexel = 1 / 1155.0;                               // a third of a pixel of the d400
constexpr int kDotsAcross = 96, kDotsDown = 72;
constexpr double kDotSigma = 3;  // texels

/// One dot somewhere in each cell of a grid, so that no window is without.
cv::Mat makeDots() {
  const int width = static_cast<int>(2 * kHalfWidth / kTexel),
            height = static_cast<int>(2 * kHalfHeight / kTexel);
  cv::Mat dots(height, width, CV_32FC1, cv::Scalar(0));
  Rng rng(20, 11);
  constexpr int kReach = 9;
  for (int row = 0; row < kDotsDown; ++row)
    for (int column = 0; column < kDotsAcross; ++column) {
      const double x = (column + rng.uniform()) * width / kDotsAcross,
                   y = (row + rng.uniform()) * height / kDotsDown, power = rng.uniform(0.5, 1);
      for (int v = std::max(0, int(y) - kReach); v <= std::min(height - 1, int(y) + kReach); ++v)
        for (int u = std::max(0, int(x) - kReach); u <= std::min(width - 1, int(x) + kReach); ++u) {
          const double squared = (u - x) * (u - x) + (v - y) * (v - y);
          float& value = dots.at<float>(v, u);
          value = std::max(value, float(power * std::exp(-squared / (2 * kDotSigma * kDotSigma))));
        }
    }
  return dots;
}

}  // namespace

float dotPattern(double tangent_x, double tangent_y) {
  static const cv::Mat dots = makeDots();
  const double x = (tangent_x + kHalfWidth) / kTexel, y = (tangent_y + kHalfHeight) / kTexel;
  if (x < 0 || y < 0 || x >= dots.cols - 1 || y >= dots.rows - 1) return 0;
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const auto a = static_cast<float>(x - u), b = static_cast<float>(y - v);
  const float *top = dots.ptr<float>(v) + u, *bottom = dots.ptr<float>(v + 1) + u;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

cv::Mat meanOfLike(const cv::Mat& disparity, int reach, float like, double least_share) {
  cv::Mat means(disparity.size(), CV_32FC1, cv::Scalar(0));
  const double least = least_share * (2 * reach + 1) * (2 * reach + 1);
  for (int v = 0; v < disparity.rows; ++v)
    for (int u = 0; u < disparity.cols; ++u) {
      const float centre = disparity.at<float>(v, u);
      if (centre <= 0) continue;
      float sum = 0;
      int count = 0;
      for (int y = std::max(0, v - reach); y <= std::min(disparity.rows - 1, v + reach); ++y) {
        const float* row = disparity.ptr<float>(y);
        for (int x = std::max(0, u - reach); x <= std::min(disparity.cols - 1, u + reach); ++x) {
          const bool counts = row[x] > 0 && std::abs(row[x] - centre) <= like;
          sum += counts ? row[x] : 0.0f;
          count += counts;
        }
      }
      if (count >= least) means.at<float>(v, u) = sum / static_cast<float>(count);
    }
  return means;
}

InfraredView viewInfrared(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                          double longest) {
  const Scene& scene = tracer.scene();
  const Eigen::Vector3d origin = world_from_camera.translation();
  const Eigen::Vector3d lamp = (scene.up + Eigen::Vector3d(0.4, 0.25, 0.3)).normalized();
  InfraredView view;
  for (cv::Mat* image : {&view.depth, &view.albedo, &view.facing, &view.daylight})
    *image = cv::Mat(intrinsics.height, intrinsics.width, CV_32FC1, cv::Scalar(0));
  castImage(tracer, intrinsics, world_from_camera, longest,
            [&](int row, int column, const Tracer::Hit& hit, const Eigen::Vector3d& direction) {
              if (hit.triangle == Tracer::kNone) return;
              const Eigen::Vector3f rgb = surfaceColour(scene, hit, origin + hit.distance * direction);
              view.depth.at<float>(row, column) = static_cast<float>(hit.distance);
              view.albedo.at<float>(row, column) = 0.4f * rgb.x() + 0.35f * rgb.y() + 0.25f * rgb.z();
              view.facing.at<float>(row, column) =
                  static_cast<float>(-hit.normal.dot(direction) / direction.norm());
              view.daylight.at<float>(row, column) =
                  0.6f + 0.55f * static_cast<float>(std::abs(hit.normal.dot(lamp)));
            });
  return view;
}

ProjectorShadow::ProjectorShadow(const Tracer& tracer, const Pose& world_from_projector, double longest)
    : depth_(renderDepth(tracer, kProjector, world_from_projector, longest)) {}

bool ProjectorShadow::isLit(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d pixel = kProjector.project(point);
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  if (u < 0 || v < 0 || u >= depth_.cols || v >= depth_.rows) return false;
  // Slanted surfaces differ within a pixel of the map: the farthest neighbour counts.
  float farthest = depth_.at<float>(v, u);
  for (const int x : {u - 1, u + 1})
    if (x >= 0 && x < depth_.cols) farthest = std::max(farthest, depth_.at<float>(v, x));
  return farthest <= 0 || point.z() < 1.01 * farthest;
}

}  // namespace rosefusion
