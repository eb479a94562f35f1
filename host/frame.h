// One depth frame as it comes from a sequence or a camera.
#pragma once
#include <opencv2/core/mat.hpp>

namespace rosefusion {

/// depth: CV_16UC1, width x height of the sequence's intrinsics; metres = value / depth_units_per_metre; 0
/// and 65535 are invalid. colour: CV_8UC3 in BGR order, registered to the depth image, same size; empty when
/// there is none.
struct Frame {
  double timestamp = 0;  ///< seconds
  cv::Mat depth;
  cv::Mat colour;
};

}  // namespace rosefusion
