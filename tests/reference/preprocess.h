// Reference of pass preprocess, in double precision.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/camera.h"
#include "tests/reference/comparison.h"

namespace rosefusion::reference {

struct DepthSensor {
  double metres_per_unit = 0.0002;
  double min_depth = 0.3;  ///< metres
  double max_depth = 6;
};

/// Row by row; depth 0 where invalid, and its point then the origin.
struct PointImage {
  std::vector<double> depth;
  std::vector<Eigen::Vector3d> points;  ///< camera frame, metres
};

PointImage preprocess(std::span<const std::uint16_t> raw, const Intrinsics& camera,
                      const DepthSensor& sensor);

/// `depth`: metres per pixel; `points`: x, y, z, valid per pixel.
Comparison compare(const PointImage& expected, std::span<const float> depth, std::span<const float> points);

}  // namespace rosefusion::reference
