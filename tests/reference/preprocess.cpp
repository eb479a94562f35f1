#include "tests/reference/preprocess.h"

#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {
// Of a bend, relative to z: three reciprocals times z squared, about 4 z in all before they cancel, each of
// some 2^-23 with the 2.5 ulp of a division.
constexpr double kBendTolerance = 2e-6;

double metres(std::uint16_t raw, const DepthSensor& sensor) {
  const double z = raw * sensor.metres_per_unit;
  return raw == 0 || raw == 65535 || z < sensor.min_depth || z > sensor.max_depth ? 0 : z;
}

/// By how much the middle of three depths leaves the line through the outer two, metres; 0 when one of them
/// is missing.
double bendOf(double before, double z, double after) {
  if (before <= 0 || after <= 0) return 0;
  const double inverse_on_plane = (1 / before + 1 / after) / 2;
  return 2 * z * z * std::abs(inverse_on_plane - 1 / z);
}

}  // namespace

PointImage preprocess(std::span<const std::uint16_t> raw, const Intrinsics& camera,
                      const DepthSensor& sensor) {
  PointImage image;
  const auto depthAt = [&](int u, int v) {
    const bool inside = u >= 0 && v >= 0 && u < camera.width && v < camera.height;
    return inside ? metres(raw[std::size_t(v) * camera.width + u], sensor) : 0;
  };
  std::size_t i = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u, ++i) {
      double z = metres(raw[i], sensor);
      bool uncertain = false;
      if (z > 0 && sensor.edge_sigmas > 0) {
        const int r = sensor.edge_reach;
        const double bend = std::max(bendOf(depthAt(u - r, v), z, depthAt(u + r, v)),
                                     bendOf(depthAt(u, v - r), z, depthAt(u, v + r)));
        const double most = sensor.edge_sigmas * sensor.noise.deviation(z);
        uncertain = std::abs(bend - most) < kBendTolerance * z;
        if (bend > most) z = 0;
      }
      image.uncertain.push_back(uncertain);
      image.depth.push_back(z);
      image.points.push_back(camera.unproject(u, v, z));
    }
  return image;
}

Comparison compare(const PointImage& expected, std::span<const float> depth, std::span<const float> points,
                   double relative_tolerance) {
  Comparison result;
  for (std::size_t i = 0; i < expected.depth.size(); ++i) {
    if (expected.uncertain[i]) {
      ++result.skipped;
      continue;
    }
    const double z = expected.depth[i];
    const float* p = &points[4 * i];
    const bool same_validity = (z > 0) == (depth[i] > 0) && (z > 0) == (p[3] == 1) && (z > 0 || p[3] == 0);
    // Relative to the range to the point: x and y may be 0.
    const double tolerance = relative_tolerance * std::max(expected.points[i].norm(), 1e-30);
    const double error =
        std::max(std::abs(z - depth[i]), (expected.points[i] - Eigen::Vector3d(p[0], p[1], p[2])).norm());
    result.add(
        same_validity ? error / tolerance : INFINITY,
        "pixel " + std::to_string(i) + ": z " + std::to_string(depth[i]) + ", expected " + std::to_string(z));
  }
  return result;
}

}  // namespace rosefusion::reference
