// Depth and colour images of a scene.
#pragma once
#include <atomic>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "host/core/camera.h"
#include "host/synth/tracer.h"

namespace rosefusion {

/// Depth along the optical axis, CV_32FC1 in metres, at the pixels' centres; 0 where nothing lies within
/// `max_depth` metres. With `seen` (one entry per triangle) the triangles hit are set to 1; threads may share
/// it.
cv::Mat renderDepth(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera,
                    double max_depth = 10, std::vector<std::uint8_t>* seen = nullptr);

/// Colour image, CV_8UC3 in BGR order: the scene's materials under one fixed lamp and ambient light
/// (Lambert).
cv::Mat renderColour(const Tracer& tracer, const Intrinsics& intrinsics, const Pose& world_from_camera);

/// What the surface reflects where a ray met it (RGB, 0 to 1), before shading; `point` in the world.
Eigen::Vector3f surfaceColour(const Scene& scene, const Tracer::Hit& hit, const Eigen::Vector3d& point);

}  // namespace rosefusion
