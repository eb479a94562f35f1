// Which true pose belongs to which estimated pose.
#pragma once
#include <vector>

#include "host/core/trajectory.h"

namespace rosefusion {

enum class Association {
  Nearest,       ///< the true pose with the nearest stamp, one to one (as the TUM RGB-D tools and evo do)
  Interpolated,  ///< the truth interpolated at the estimate's stamps
};

struct PosePair {
  double timestamp = 0;  ///< of the estimate, seconds
  Pose estimate = Pose::Identity();
  Pose truth = Pose::Identity();
};

/// Pairs in order of time. Both trajectories must be sorted and finite.
/// Nearest: stamps at most `max_difference_s` apart; where two estimates want one true pose, the closer one
/// gets it. Interpolated: between true poses at most twice `max_difference_s` apart, never beyond the truth's
/// ends.
std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth, Association association,
                                double max_difference_s);

}  // namespace rosefusion
