// A picture of the whole model: a view from above into it, with the camera's path.
#pragma once
#include <opencv2/core/mat.hpp>
#include <span>

#include "host/core/trajectory.h"
#include "host/slam/pipeline.h"

namespace rosefusion {

/// Where a camera stands that sees all of the model and of the path from obliquely above. "Up" is what the
/// recording cameras had for up on average; surfaces are seen from their front only, so that ceilings and
/// near walls do not hide the inside.
Pose overviewPose(const Volume& volume, const Trajectory& trajectory, const Intrinsics& view);

/// CV_8UC3 (BGR) picture of the model with the path, blue at its start to red at its end; or, where `shades`
/// (0 to 1, one for each pose) are given, dark for 0 to bright for 1 (viridis). Submits work and waits.
cv::Mat renderOverview(Pipeline& pipeline, const Trajectory& trajectory, std::span<const double> shades = {});

}  // namespace rosefusion
