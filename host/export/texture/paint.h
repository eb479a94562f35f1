// Colours of a texture.
#pragma once
#include <opencv2/core/mat.hpp>

#include "host/export/texture/layout.h"

namespace rosefusion {

/// Copies what a view's image (CV_8UC3) shows of a chart into the texture, so that a renderer, which lays
/// each triangle on flat, finds at every texel what the camera saw there in perspective.
void paintChart(cv::Mat& texture, const TextureLayout& layout, const Chart& chart, const TriangleMesh& mesh,
                const TextureView& view, const Intrinsics& camera, const cv::Mat& colour);

/// The vertices' colours, or grey where the mesh has none.
void paintSwatches(cv::Mat& texture, const TextureLayout& layout, const TriangleMesh& mesh);

}  // namespace rosefusion
