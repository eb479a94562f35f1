// Reference of pass preprocess, in double precision.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/camera.h"
#include "tests/reference/comparison.h"
#include "tests/reference/depth_noise.h"

namespace rosefusion::reference {

/// Of a pixel's point, relative; single precision: the product of two rounded numbers for z; for x and y, as
/// well, a difference of pixel coordinates with an absolute error of half an ulp of the image's width, and a
/// division with the 2.5 ulp that Vulkan allows.
inline constexpr double kPointTolerance = 1e-6;
/// Metres, of a position in a camera's frame, single precision: 2^-23 * 4 m * a few operations.
inline constexpr double kPositionError = 2e-6;

struct DepthSensor {
  double metres_per_unit = 0.0002;
  double min_depth = 0.3;  ///< metres
  double max_depth = 6;
  /// More than 0: a pixel is invalid where the depths `edge_reach` pixels to both sides, along either axis,
  /// leave the plane through it (1 / z is linear in the image) by more than so many standard deviations.
  double edge_sigmas = 0;
  int edge_reach = 2;
  DepthNoise noise;
};

/// Row by row; depth 0 where invalid, and its point then the origin.
struct PointImage {
  std::vector<double> depth;
  std::vector<Eigen::Vector3d> points;  ///< camera frame, metres
  std::vector<bool> uncertain;          ///< rounding decides whether it is an edge
};

PointImage preprocess(std::span<const std::uint16_t> raw, const Intrinsics& camera,
                      const DepthSensor& sensor);

/// `depth`: metres per pixel; `points`: x, y, z, valid per pixel.
Comparison compare(const PointImage& expected, std::span<const float> depth, std::span<const float> points,
                   double relative_tolerance = kPointTolerance);

}  // namespace rosefusion::reference
