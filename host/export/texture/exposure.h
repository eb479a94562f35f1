// How bright a view's image is beside the others.
#pragma once
#include <opencv2/core/mat.hpp>
#include <vector>

#include "host/export/texture/visibility.h"

namespace rosefusion {

/// What the three channels (BGR) of a view's image are to be multiplied by.
using Gains = cv::Vec3d;

/// The median of what takes the image's colours to the mesh's, which are the mean of all frames that saw
/// them, so that views agree where they meet. 1 where the mesh has no colours, or too little is seen.
Gains gainsOf(const TriangleMesh& mesh, const std::vector<SeenTriangle>& seen, const TextureView& view,
              const Intrinsics& camera, const cv::Mat& colour);

/// The image (CV_8UC3) with its channels multiplied.
cv::Mat levelled(const cv::Mat& colour, const Gains& gains);

}  // namespace rosefusion
