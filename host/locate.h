// Where in a model a frame was taken, when little is known about it.
#pragma once
#include <span>

#include "host/pose_method.h"

namespace rosefusion {

/// Around each centre a wide swarm is scanned; the best few are searched and let down to the surface. The
/// result's fit says whether to believe it: every valid pixel counts, also what the model does not hold.
TrackResult locate(SwarmSearch& search, Refiner& refiner, const RefineSettings& settings,
                   const PreprocessPass& frame, const Volume& volume, std::span<const Pose> centres,
                   const SearchObserver& observer = {});

}  // namespace rosefusion
