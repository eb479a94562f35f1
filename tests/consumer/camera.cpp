// The camera that the README's quickstart leaves to its reader: it slides and turns in a box with a ball.
#include <cmath>
#include <cstdint>
#include <vector>

namespace {
constexpr int kWidth = 320, kHeight = 240, kFrames = 8;
constexpr double kFocal = 160, kStep = 0.03;  // pixels, metres per frame

/// Depth along the axis of what lies in direction (x, y, 1) from (left, 0, 0): a box of 4 x 3 x 4 m, 2.5 m of
/// it ahead, and a ball before its far wall.
double depthAt(double left, double x, double y) {
  double depth = 2.5;
  if (x != 0) depth = std::fmin(depth, (std::copysign(2, x) - left) / x);
  if (y != 0) depth = std::fmin(depth, 1.5 / std::fabs(y));
  const double cx = 0.3 - left, cy = 0.2, cz = 1.8, radius = 0.4, a = x * x + y * y + 1;
  const double b = x * cx + y * cy + cz, c = cx * cx + cy * cy + cz * cz - radius * radius;
  return b * b > a * c ? (b - std::sqrt(b * b - a * c)) / a : depth;
}
}  // namespace

bool readCamera(std::vector<std::uint16_t>& depth, double& seconds) {
  static int frame = 0;
  if (frame == kFrames) return false;
  depth.clear();
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      depth.push_back(static_cast<std::uint16_t>(
          std::lround(1000 * depthAt(kStep * frame, (u - 159.5) / kFocal, (v - 119.5) / kFocal))));
  seconds = frame++ / 30.0;
  return true;
}
