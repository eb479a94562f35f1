#include "host/synth/renderer.h"

#include <opencv2/core.hpp>

#include "host/synth/cast_image.h"

namespace rosefusion {
namespace {

constexpr double kFarthest = 1000;

}  // namespace

Eigen::Vector3f surfaceColour(const Scene& scene, const Tracer::Hit& hit, const Eigen::Vector3d& point) {
  if (!scene.face_material.empty())
    return materialColour(scene.materials[scene.face_material[hit.triangle]], point);
  const auto& t = scene.mesh.triangles[hit.triangle];
  const float weights[] = {1 - hit.u - hit.v, hit.u, hit.v};
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) colour[c] += weights[i] * scene.mesh.colours[t[i]][c] / 255.0f;
  return colour;
}

cv::Mat renderDepth(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                    double max_depth, std::vector<std::uint8_t>* seen) {
  cv::Mat depth(intrinsics.height, intrinsics.width, CV_32FC1);
  castImage(tracer, intrinsics, world_from_camera, max_depth,
            [&](int row, int column, const Tracer::Hit& hit, const Eigen::Vector3d&) {
              const bool valid = hit.triangle != Tracer::kNone;
              depth.at<float>(row, column) = valid ? static_cast<float>(hit.distance) : 0.0f;
              if (valid && seen)
                std::atomic_ref((*seen)[hit.triangle]).store(std::uint8_t{1}, std::memory_order_relaxed);
            });
  return depth;
}

cv::Mat renderColour(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera) {
  const Scene& scene = tracer.scene();
  const Eigen::Vector3d origin = world_from_camera.translation();
  const Eigen::Vector3d lamp = (scene.up + Eigen::Vector3d(0.4, 0.25, 0.3)).normalized();
  cv::Mat colour(intrinsics.height, intrinsics.width, CV_8UC3, cv::Scalar::all(0));
  castImage(tracer, intrinsics, world_from_camera, kFarthest,
            [&](int row, int column, const Tracer::Hit& hit, const Eigen::Vector3d& direction) {
              if (hit.triangle == Tracer::kNone) return;
              const float light = 0.6f + 0.55f * static_cast<float>(std::abs(hit.normal.dot(lamp)));
              const Eigen::Vector3f rgb =
                  255 * light * surfaceColour(scene, hit, origin + hit.distance * direction);
              colour.at<cv::Vec3b>(row, column) = {cv::saturate_cast<std::uint8_t>(rgb.z()),
                                                   cv::saturate_cast<std::uint8_t>(rgb.y()),
                                                   cv::saturate_cast<std::uint8_t>(rgb.x())};
            });
  return colour;
}

}  // namespace rosefusion
