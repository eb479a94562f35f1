// The paper's pose search and those it is compared with, behind one interface; tracking.method chooses.
#pragma once
#include <memory>

#include "host/slam/tracking/pose_method.h"
#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

/// The one that tracking.method names. `search` and `refiner` must outlive it.
std::unique_ptr<PoseMethod> makePoseMethod(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, SwarmSearch& search,
                                           PoseRefiner& refiner);

}  // namespace rosefusion
