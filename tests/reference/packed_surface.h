// What pass raycast stores of a pixel's surface, unpacked in doubles.
#pragma once
#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>

namespace rosefusion::reference {

/// Unit normal and depth; all 0 where nothing was hit.
inline Eigen::Vector4d unpackedSurface(std::uint32_t normal, std::uint32_t depth) {
  const double z = std::bit_cast<float>(depth);
  if (z == 0) return Eigen::Vector4d::Zero();
  const auto coordinate = [&](int shift) {
    return static_cast<std::int16_t>(normal >> shift & 0xFFFF) / 32767.0;
  };
  // The square's centre is +z; what lies outside the diamond |x| + |y| = 1 was mirrored at its nearest side.
  Eigen::Vector3d n(coordinate(0), coordinate(16), 0);
  n.z() = 1 - n.cwiseAbs().sum();
  if (n.z() < 0) {
    const double x = n.x(), y = n.y();
    n.x() = std::copysign(1 - std::abs(y), x);
    n.y() = std::copysign(1 - std::abs(x), y);
  }
  n.normalize();
  return {n.x(), n.y(), n.z(), z};
}

}  // namespace rosefusion::reference
