// Ground-truth poses as data sets store them; bad poses are left out with a warning.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/core/trajectory.h"

namespace rosefusion::datasets {

/// A TUM-format truth file; an empty trajectory when there is no such file. Unsorted stamps are sorted, and
/// lines with NaN, a zero quaternion or other damage skipped, each with one warning for the file.
Trajectory readTruth(const std::filesystem::path& file, std::vector<std::string>& warnings);

/// world_from_camera from the 16 numbers of a row-major 4x4 matrix. False when a number is not finite, the
/// last row is not 0 0 0 1, or the 3x3 part is no rotation (to 5 %: stored poses are rounded); it is
/// orthonormalised.
bool poseFromMatrix(const std::vector<double>& numbers, Pose& pose);

}  // namespace rosefusion::datasets
