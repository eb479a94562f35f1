// Measures what the first depth images show: how far the scene is, and how noisy its flat surfaces are.
#pragma once
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "host/core/camera.h"
#include "host/settings/automatic.h"

namespace rosefusion {

/// `depths` as Frame::depth; `range` gives the depths that count. None where hardly a pixel has any.
std::optional<SceneMeasures> surveyScene(std::span<const cv::Mat> depths, const Intrinsics& camera,
                                         double depth_units_per_metre, const DepthSettings& range);

}  // namespace rosefusion
