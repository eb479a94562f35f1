// What one view sees of a mesh, and how well.
#pragma once
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "host/export/texture/views.h"

namespace rosefusion {

struct SeenTriangle {
  std::uint32_t triangle = 0;
  float quality = 0;  ///< pixels per metre, in the direction in which they are fewest
};

struct SeeingOptions {
  double detail = 0.02;                           ///< metres that the mesh tells surfaces apart by
  std::function<double(double)> depth_tolerance;  ///< metres, at a depth in metres
};

/// The triangles that face the view, lie in its image whole, are hidden by no other and are where its depth
/// image (metres, CV_32F of the camera's size; 0 where it has none) has a surface too. Near the edge of
/// something that hides, a tenth of the quality: images and mesh do not agree to the pixel.
std::vector<SeenTriangle> seenTriangles(const TriangleMesh& mesh, const Intrinsics& camera,
                                        const TextureView& view, const cv::Mat& depth,
                                        const SeeingOptions& options);

}  // namespace rosefusion
