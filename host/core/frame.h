// One depth frame as it comes from a sequence or a camera.
#pragma once
#include <opencv2/core/mat.hpp>
#include <optional>

#include "host/core/camera.h"

namespace rosefusion {

/// How the camera moved, as another sensor than its own depth says: a gyroscope, wheels, a robot's arm.
struct CameraMotion {
  Pose last_camera_from_camera = Pose::Identity();  ///< the camera now, in the frame of the camera before
  bool has_translation = false;                     ///< false: only the rotation is known
};

/// depth: CV_16UC1, width x height of the sequence's intrinsics; metres = value / depth_units_per_metre; 0
/// and 65535 are invalid. colour: CV_8UC3 in BGR order, registered to the depth image, same size; empty when
/// there is none.
struct Frame {
  double timestamp = 0;  ///< seconds
  cv::Mat depth;
  cv::Mat colour;
  std::optional<CameraMotion> motion;  ///< since the frame before this one, whatever became of that
};

}  // namespace rosefusion
