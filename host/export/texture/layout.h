// Where each triangle lies in the texture.
#pragma once
#include <opencv2/core/types.hpp>
#include <vector>

#include "host/export/texture/labels.h"

namespace rosefusion {

/// Triangles that hang together, cut from one view's image.
struct Chart {
  int view = 0;
  std::vector<std::uint32_t> triangles;
  cv::Rect2d box;  ///< of their pixels in the view's image; its corner is a whole one
  cv::Rect place;  ///< in the texture
};

/// Some triangles that no view sees, kSwatch texels wide each, side by side, with their vertices' colours.
struct Swatches {
  std::vector<std::uint32_t> triangles;
  cv::Rect place;
};

struct TextureLayout {
  std::vector<Chart> charts;
  std::vector<Swatches> swatches;
  int width = 0, height = 0;  ///< of the texture
  double scale = 1;           ///< texels for a pixel of the images, at most 1
  int swatch = 4;  ///< texels that an unseen triangle is wide and high: 4, or 2 where there are many
};

inline constexpr int kChartMargin = 2;  ///< texels around a chart, for filters that look at neighbours

/// As small as holds the images' pixels, at most `largest` texels wide and high: pixels are made larger until
/// they fit. Throws InputError where it is too small even so.
TextureLayout layOut(const TriangleMesh& mesh, const std::vector<int>& labels,
                     const std::vector<TextureView>& views, const Intrinsics& camera, int largest);

/// Pixel of a view's image where a point of the world lies.
Eigen::Vector2d pixelIn(const TextureView& view, const Intrinsics& camera, const Eigen::Vector3f& point);

/// Texel coordinates (texel centres have integers, as pixels') of the corners of triangle `index` of a chart
/// or of swatches.
std::array<Eigen::Vector2d, 3> texelsOf(const TextureLayout& layout, const Chart& chart, std::size_t index,
                                        const TriangleMesh& mesh, const TextureView& view,
                                        const Intrinsics& camera);
std::array<Eigen::Vector2d, 3> texelsOf(const TextureLayout& layout, const Swatches& swatches,
                                        std::size_t index);

}  // namespace rosefusion
