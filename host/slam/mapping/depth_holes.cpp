#include "host/slam/mapping/depth_holes.h"

#include <algorithm>
#include <cstdlib>

namespace rosefusion {
namespace {

constexpr int kReach = 2;
// The two sides of a hole in a surface differ by less than this share of the depth, those at an edge by more.
// It is what the checks of free space take for one surface.
constexpr int kOneSurface = 20;  // 1 / share
constexpr struct {
  int u, v;
} kOpposite[] = {{1, 0}, {0, 1}, {1, 1},  {1, -1}, {2, 0}, {0, 2},
                 {2, 1}, {1, 2}, {2, -1}, {1, -2}, {2, 2}, {2, -2}};

bool isHole(std::uint16_t depth) {
  return depth == 0 || depth == 65535;
}

}  // namespace

cv::Mat withSmallHolesFilled(const cv::Mat& depth) {
  cv::Mat filled = depth.clone();
  for (int v = kReach; v + kReach < depth.rows; ++v) {
    std::uint16_t* out = filled.ptr<std::uint16_t>(v);
    for (int u = kReach; u + kReach < depth.cols; ++u) {
      if (!isHole(out[u])) continue;
      for (const auto& side : kOpposite) {
        const int a = depth.at<std::uint16_t>(v + side.v, u + side.u);
        const int b = depth.at<std::uint16_t>(v - side.v, u - side.u);
        if (isHole(static_cast<std::uint16_t>(a)) || isHole(static_cast<std::uint16_t>(b)) ||
            kOneSurface * std::abs(a - b) > std::min(a, b))
          continue;
        out[u] = static_cast<std::uint16_t>((a + b) / 2);
        break;
      }
    }
  }
  return filled;
}

}  // namespace rosefusion
