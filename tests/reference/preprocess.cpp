#include "tests/reference/preprocess.h"

#include <cmath>

namespace rosefusion::reference {
namespace {
// Single precision: the product of two rounded numbers for z; for x and y, as well, a difference of pixel
// coordinates with an absolute error of half an ulp of the image's width, and a division with the 2.5 ulp
// that Vulkan allows.
constexpr double kRelativeTolerance = 1e-6;
}  // namespace

PointImage preprocess(std::span<const std::uint16_t> raw, const Intrinsics& camera,
                      const DepthSensor& sensor) {
  PointImage image;
  std::size_t i = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u, ++i) {
      double z = raw[i] * sensor.metres_per_unit;
      if (raw[i] == 0 || raw[i] == 65535 || z < sensor.min_depth || z > sensor.max_depth) z = 0;
      image.depth.push_back(z);
      image.points.push_back(camera.unproject(u, v, z));
    }
  return image;
}

Comparison compare(const PointImage& expected, std::span<const float> depth, std::span<const float> points) {
  Comparison result;
  for (std::size_t i = 0; i < expected.depth.size(); ++i) {
    const double z = expected.depth[i];
    const float* p = &points[4 * i];
    const bool same_validity = (z > 0) == (depth[i] > 0) && (z > 0) == (p[3] == 1) && (z > 0 || p[3] == 0);
    // Relative to the range to the point: x and y may be 0.
    const double tolerance = kRelativeTolerance * std::max(expected.points[i].norm(), 1e-30);
    const double error =
        std::max(std::abs(z - depth[i]), (expected.points[i] - Eigen::Vector3d(p[0], p[1], p[2])).norm());
    result.add(
        same_validity ? error / tolerance : INFINITY,
        "pixel " + std::to_string(i) + ": z " + std::to_string(depth[i]) + ", expected " + std::to_string(z));
  }
  return result;
}

}  // namespace rosefusion::reference
