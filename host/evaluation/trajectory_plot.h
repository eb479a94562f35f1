// The picture of a trajectory's errors.
#pragma once
#include <filesystem>
#include <string>

#include "host/evaluation/trajectory_error.h"

namespace rosefusion {

/// Left: true and (aligned) estimated camera positions along the two axes of the truth's frame with the
/// largest extent. Right: both errors over time. `title` heads the picture. Throws as renderPlot does;
/// InputError also when there is no common pose. `truth` is
/// what the errors were measured against.
void plotTrajectoryErrors(const TrajectoryErrors& errors, const Trajectory& truth, const std::string& title,
                          const std::filesystem::path& png);

}  // namespace rosefusion
