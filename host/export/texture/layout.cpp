#include "host/export/texture/layout.h"

#include <algorithm>
#include <cmath>

#include "host/core/error.h"
#include "host/export/texture/packing.h"

namespace rosefusion {
namespace {

/// All places begin at multiples of it: squares in which JPEG joins colours, and two steps of smaller
/// textures.
constexpr int kUnit = 4;
constexpr std::size_t kSwatchesInRow = 32;

int units(double texels) {
  return static_cast<int>(std::ceil(texels / kUnit));
}

/// A chart's box in whole pixels of the image, and what it takes up in the texture, in units.
cv::Rect placeOf(const Chart& chart, double scale) {
  return {0, 0, units(chart.box.width * scale + 1 + 2 * kChartMargin),
          units(chart.box.height * scale + 1 + 2 * kChartMargin)};
}

bool fits(TextureLayout& layout, int width, int height, double scale, int swatch) {
  std::vector<cv::Rect> places;
  for (const Chart& chart : layout.charts) places.push_back(placeOf(chart, scale));
  for (const Swatches& s : layout.swatches)
    places.emplace_back(0, 0, units(static_cast<double>(s.triangles.size()) * swatch), units(swatch));
  if (!packed(places, width / kUnit, height / kUnit)) return false;
  int bottom = 1;
  for (cv::Rect& place : places) {
    place = {place.x * kUnit, place.y * kUnit, place.width * kUnit, place.height * kUnit};
    bottom = std::max(bottom, place.y + place.height);
  }
  const std::size_t charts = layout.charts.size();
  for (std::size_t i = 0; i < charts; ++i) layout.charts[i].place = places[i];
  for (std::size_t i = 0; i < layout.swatches.size(); ++i) layout.swatches[i].place = places[charts + i];
  layout.width = width;
  layout.height = bottom;
  layout.scale = scale;
  layout.swatch = swatch;
  return true;
}

/// Whether a texture of this size has the room at all, which is asked before the longer search.
double area(const TextureLayout& layout, double scale, int swatch) {
  double sum = 0;
  for (const Chart& chart : layout.charts) sum += placeOf(chart, scale).area();
  for (const Swatches& s : layout.swatches)
    sum += units(static_cast<double>(s.triangles.size()) * swatch) * units(swatch);
  return sum * kUnit * kUnit;
}

}  // namespace

Eigen::Vector2d pixelIn(const TextureView& view, const Intrinsics& camera, const Eigen::Vector3f& point) {
  return camera.project(view.world_from_camera.inverse() * point.cast<double>());
}

TextureLayout layOut(const TriangleMesh& mesh, const std::vector<int>& labels,
                     const std::vector<TextureView>& views, const Intrinsics& camera, int largest) {
  TextureLayout layout;
  std::vector<std::uint32_t> unseen;
  for (auto& part : partsOf(labels, neighboursOf(mesh))) {
    const int label = labels[part.front()];
    if (label == kNoView) {
      unseen.insert(unseen.end(), part.begin(), part.end());
      continue;
    }
    Eigen::Vector2d low(1e9, 1e9), high = -low;
    for (const std::uint32_t t : part)
      for (const std::uint32_t v : mesh.triangles[t]) {
        const Eigen::Vector2d p = pixelIn(views[static_cast<std::size_t>(label)], camera, mesh.vertices[v]);
        low = low.cwiseMin(p), high = high.cwiseMax(p);
      }
    low = low.array().floor();
    layout.charts.push_back(
        {label, std::move(part), {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()}, {}});
  }
  for (std::size_t i = 0; i < unseen.size(); i += kSwatchesInRow) {
    const auto begin = unseen.begin() + static_cast<std::ptrdiff_t>(i);
    const auto count = static_cast<std::ptrdiff_t>(std::min(kSwatchesInRow, unseen.size() - i));
    layout.swatches.push_back({{begin, begin + count}, {}});
  }
  const auto tooLarge = [&](int side, double scale, int swatch) {
    return area(layout, scale, swatch) > static_cast<double>(side) * side;
  };
  // Small where all fits; what no view saw may take up a quarter at most before it is made smaller.
  const int swatch =
      64.0 * static_cast<double>(unseen.size()) > static_cast<double>(largest) * largest ? 2 : 4;
  for (int side = std::min(256, largest); side < largest; side = std::min(2 * side, largest))
    if (!tooLarge(side, 1, swatch) &&
        (fits(layout, side, side / 2, 1, swatch) || fits(layout, side, side, 1, swatch)))
      return layout;
  for (double scale = 1; scale > 0.02; scale *= 0.95)
    if (!tooLarge(largest, scale, swatch) && fits(layout, largest, largest, scale, swatch)) return layout;
  throw InputError("--texture-size: " + std::to_string(largest) + " texels are too few for " +
                   std::to_string(mesh.triangles.size()) +
                   " triangles; give more, or have fewer triangles with --max-error.");
}

std::array<Eigen::Vector2d, 3> texelsOf(const TextureLayout& layout, const Chart& chart, std::size_t index,
                                        const TriangleMesh& mesh, const TextureView& view,
                                        const Intrinsics& camera) {
  std::array<Eigen::Vector2d, 3> texels;
  const Eigen::Vector2d corner(chart.box.x, chart.box.y), place(chart.place.x, chart.place.y);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d p = pixelIn(view, camera, mesh.vertices[mesh.triangles[chart.triangles[index]][i]]);
    texels[i] = place + Eigen::Vector2d::Constant(kChartMargin) + layout.scale * (p - corner);
  }
  return texels;
}

std::array<Eigen::Vector2d, 3> texelsOf(const TextureLayout& layout, const Swatches& swatches,
                                        std::size_t index) {
  // Corners a texel apart, in the middle where there is one: bilinear filtering blends their colours exactly.
  const int border = layout.swatch / 4;
  const Eigen::Vector2d corner(swatches.place.x + static_cast<int>(index) * layout.swatch + border,
                               swatches.place.y + border);
  return {corner, corner + Eigen::Vector2d(1, 0), corner + Eigen::Vector2d(0, 1)};
}

}  // namespace rosefusion
