// How far each part of a depth image sees: what lies behind all of its surfaces need not be looked at.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <utility>

namespace rosefusion {

/// The largest depth in each square tile of the image, row by row; 0 where a tile has none.
struct DepthReach {
  std::span<const float> farthest;  ///< metres
  int columns = 0;
  int tile = 1;  ///< pixels along a tile's side

  /// Whether the ball around `centre` (camera frame) lies more than `margin` behind the surfaces in all
  /// pixels that may show it. `focal_centre`, `size`: the camera, as shader::CameraIntrinsics.
  bool hides(const glm::vec3& centre, float radius, float margin, const glm::vec4& focal_centre,
             const glm::ivec4& size) const {
    constexpr float kRounding = 1e-3f;  // metres, and pixels by far
    const float nearest = centre.z - radius;
    if (nearest < kRounding) return false;
    const auto tilesOf = [&](float across, float focal, float middle, int pixels, int& first, int& last) {
      const float low = across - radius, high = across + radius, most = centre.z + radius;
      float a = focal * low / (low < 0 ? nearest : most) + middle,
            b = focal * high / (high > 0 ? nearest : most) + middle;
      if (a > b) std::swap(a, b);  // negative fy
      const float border = static_cast<float>(pixels - 1);
      first = static_cast<int>(std::clamp(std::floor(a) - 1, 0.0f, border)) / tile;
      last = static_cast<int>(std::clamp(std::ceil(b) + 1, 0.0f, border)) / tile;
    };
    int left, right, top, bottom;
    tilesOf(centre.x, focal_centre.x, focal_centre.z, size.x, left, right);
    tilesOf(centre.y, focal_centre.y, focal_centre.w, size.y, top, bottom);
    for (int row = top; row <= bottom; ++row)
      for (int column = left; column <= right; ++column)
        if (farthest[std::size_t(row) * columns + column] + margin + kRounding >= nearest) return false;
    return true;
  }
};

}  // namespace rosefusion
