// The Azure Kinect's calibration.json: its two cameras, for images of any of its modes.
#pragma once
#include <cstddef>
#include <opencv2/core/types.hpp>
#include <optional>
#include <span>
#include <string>

#include "host/core/camera.h"
#include "host/datasets/undistortion.h"

namespace rosefusion::datasets {

struct LensCamera {
  Intrinsics values;
  Distortion lens;
  Pose camera_from_depth = Pose::Identity();  ///< metres
};

/// The depth camera, for images of `size`, which are of the narrow field of view (10:9) or of the wide one
/// (1:1). Throws InputError, which begins with `name`, where the calibration cannot be read or no mode has
/// images of that shape.
LensCamera azureDepthCamera(std::span<const std::byte> calibration, cv::Size size, const std::string& name);

/// The same of the colour camera, whose images (4:3 or 16:9) are as wide as its sensor.
LensCamera azureColourCamera(std::span<const std::byte> calibration, cv::Size size, const std::string& name);

}  // namespace rosefusion::datasets
