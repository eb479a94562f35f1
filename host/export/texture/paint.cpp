#include "host/export/texture/paint.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

using Vector2 = Eigen::Vector2d;

/// The colour between four pixels, those at the border repeated.
cv::Vec3b blended(const cv::Mat& image, const Vector2& p) {
  const double x = std::clamp(p.x(), 0.0, image.cols - 1.0), y = std::clamp(p.y(), 0.0, image.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, image.cols - 1), bottom = std::min(top + 1, image.rows - 1);
  const double u = x - left, v = y - top;
  const cv::Vec3b *upper = image.ptr<cv::Vec3b>(top), *lower = image.ptr<cv::Vec3b>(bottom);
  cv::Vec3b out;
  for (int c = 0; c < 3; ++c)
    out[c] = cv::saturate_cast<std::uint8_t>((1 - v) * ((1 - u) * upper[left][c] + u * upper[right][c]) +
                                             v * ((1 - u) * lower[left][c] + u * lower[right][c]));
  return out;
}

/// Barycentric weights of a point in a triangle; false where it has no area.
bool weightsOf(const std::array<Vector2, 3>& t, const Vector2& p, Eigen::Vector3d& weights) {
  const Vector2 a = t[1] - t[0], b = t[2] - t[0], q = p - t[0];
  const double area = a.x() * b.y() - a.y() * b.x();
  if (std::abs(area) < 1e-9) return false;
  weights.y() = (q.x() * b.y() - q.y() * b.x()) / area;
  weights.z() = (a.x() * q.y() - a.y() * q.x()) / area;
  weights.x() = 1 - weights.y() - weights.z();
  return true;
}

}  // namespace

void paintChart(cv::Mat& texture, const TextureLayout& layout, const Chart& chart, const TriangleMesh& mesh,
                const TextureView& view, const Intrinsics& camera, const cv::Mat& colour) {
  const auto inImage =
      [&](const Vector2& pixel) -> Vector2 {  // of this size, be it smaller than the camera's
    return (pixel + Vector2(0.5, 0.5))
               .cwiseProduct(
                   Vector2(colour.cols / double(camera.width), colour.rows / double(camera.height))) -
           Vector2(0.5, 0.5);
  };
  const Vector2 corner(chart.box.x, chart.box.y),
      place(chart.place.x + kChartMargin, chart.place.y + kChartMargin);
  for (int y = chart.place.y; y < chart.place.br().y; ++y)  // margin and gaps, as the image has them
    for (int x = chart.place.x; x < chart.place.br().x; ++x)
      texture.at<cv::Vec3b>(y, x) = blended(colour, inImage(corner + (Vector2(x, y) - place) / layout.scale));
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const auto texels = texelsOf(layout, chart, i, mesh, view, camera);
    const Vector2 low = texels[0].cwiseMin(texels[1]).cwiseMin(texels[2]),
                  high = texels[0].cwiseMax(texels[1]).cwiseMax(texels[2]);
    const auto& t = mesh.triangles[chart.triangles[i]];
    for (int y = static_cast<int>(std::ceil(low.y())); y <= std::floor(high.y()); ++y)
      for (int x = static_cast<int>(std::ceil(low.x())); x <= std::floor(high.x()); ++x) {
        Eigen::Vector3d w;
        if (!weightsOf(texels, {x, y}, w) || w.minCoeff() < -1e-6) continue;
        const Eigen::Vector3f point = static_cast<float>(w.x()) * mesh.vertices[t[0]] +
                                      static_cast<float>(w.y()) * mesh.vertices[t[1]] +
                                      static_cast<float>(w.z()) * mesh.vertices[t[2]];
        texture.at<cv::Vec3b>(y, x) = blended(colour, inImage(pixelIn(view, camera, point)));
      }
  }
}

void paintSwatches(cv::Mat& texture, const TextureLayout& layout, const TriangleMesh& mesh) {
  for (const Swatches& swatches : layout.swatches)
    for (std::size_t i = 0; i < swatches.triangles.size(); ++i) {
      const auto corners = texelsOf(layout, swatches, i);
      const int left = swatches.place.x + static_cast<int>(i) * layout.swatch, top = swatches.place.y;
      for (int y = top; y < top + layout.swatch; ++y)
        for (int x = left; x < left + layout.swatch; ++x) {
          cv::Vec3b& texel = texture.at<cv::Vec3b>(y, x);
          if (mesh.colours.empty()) {
            texel = {128, 128, 128};
            continue;
          }
          const double b = x - corners[0].x(), c = y - corners[0].y();
          const auto& t = mesh.triangles[swatches.triangles[i]];
          for (std::size_t k = 0; k < 3; ++k)
            texel[static_cast<int>(2 - k)] = cv::saturate_cast<std::uint8_t>(
                (1 - b - c) * mesh.colours[t[0]][k] + b * mesh.colours[t[1]][k] + c * mesh.colours[t[2]][k]);
        }
    }
}

}  // namespace rosefusion
