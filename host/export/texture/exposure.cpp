#include "host/export/texture/exposure.h"

#include <algorithm>
#include <cmath>

#include "host/export/mesh_formats.h"
#include "host/export/texture/layout.h"

namespace rosefusion {

Gains gainsOf(const TriangleMesh& mesh, const std::vector<SeenTriangle>& seen, const TextureView& view,
              const Intrinsics& camera, const cv::Mat& colour) {
  constexpr std::size_t kSamples = 5000, kFewest = 50;
  constexpr int kDark = 16, kBright = 250;  // below noise rules, above the sensor is full
  if (!hasColours(mesh)) return Gains::all(1);
  std::vector<double> ratios[3];
  const std::size_t step = std::max<std::size_t>(1, seen.size() / kSamples);
  for (std::size_t i = 0; i < seen.size(); i += step) {
    const auto& t = mesh.triangles[seen[i].triangle];
    const Eigen::Vector2d p =
        pixelIn(view, camera, (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3);
    const cv::Vec3b seen_colour =
        colour.at<cv::Vec3b>(static_cast<int>(std::lround(p.y())), static_cast<int>(std::lround(p.x())));
    for (std::size_t c = 0; c < 3; ++c) {
      const int own = seen_colour[static_cast<int>(c)];
      const int fused =
          (mesh.colours[t[0]][2 - c] + mesh.colours[t[1]][2 - c] + mesh.colours[t[2]][2 - c]) / 3;
      if (std::min(own, fused) >= kDark && std::max(own, fused) <= kBright)
        ratios[c].push_back(static_cast<double>(fused) / own);
    }
  }
  Gains gains = Gains::all(1);
  for (int c = 0; c < 3; ++c) {
    if (ratios[c].size() < kFewest) continue;
    const auto middle = ratios[c].begin() + static_cast<std::ptrdiff_t>(ratios[c].size() / 2);
    std::nth_element(ratios[c].begin(), middle, ratios[c].end());
    gains[c] = *middle;
  }
  return gains;
}

cv::Mat levelled(const cv::Mat& colour, const Gains& gains) {
  cv::Mat out;
  cv::multiply(colour, cv::Scalar(gains[0], gains[1], gains[2]), out);
  return out;
}

}  // namespace rosefusion
