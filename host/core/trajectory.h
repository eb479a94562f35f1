// A camera trajectory and its text form (TUM RGB-D: `t tx ty tz qx qy qz qw`, camera to world).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

struct StampedPose {
  double timestamp = 0;  ///< seconds
  Pose world_from_camera = Pose::Identity();
};

/// Poses in ascending order of time.
using Trajectory = std::vector<StampedPose>;

/// Reads a TUM trajectory ('#' comments allowed). Throws InputError naming the file and the line for a
/// missing file, malformed or non-finite numbers, or a zero quaternion; quaternions are normalised. Unsorted
/// stamps are sorted; `was_unsorted` (optional) tells that they were. With `skipped` given, bad lines do not
/// throw: they are left out and their sentences collected there.
Trajectory readTumTrajectory(const std::filesystem::path& file, bool* was_unsorted = nullptr,
                             std::vector<std::string>* skipped = nullptr);

/// Poses that have the stamp of the one before: two runs in one file, or decimals that were lost.
std::size_t repeatedStamps(const Trajectory& trajectory);

/// Writes the whole file or, on failure, throws InputError and leaves nothing half-written.
void writeTumTrajectory(const std::filesystem::path& file, const Trajectory& trajectory);

/// Pose at time t: linear in position, slerp in rotation. False when t lies outside the trajectory by more
/// than `max_gap` seconds or between two poses further apart than that.
bool interpolate(const Trajectory& trajectory, double t, double max_gap, Pose& world_from_camera);

}  // namespace rosefusion
