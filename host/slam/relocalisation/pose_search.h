// Where in a model a frame was taken, when little is known about it.
#pragma once
#include <span>

#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

/// Around each centre a wide swarm is scanned; the best few are searched and let down to the surface. The
/// result's fit says whether to believe it: every valid pixel counts, also what the model does not hold.
/// The first `followed` centres, where the camera is expected, are followed however others compare.
/// `more`: further poses, within some centimetres of where the camera may be, that are let down too; then of
/// the other centres only the best is searched.
TrackResult locate(SwarmSearch& search, Refiner& refiner, const RefineSettings& settings,
                   const PreprocessPass& frame, const Volume& volume, std::span<const Pose> centres,
                   std::size_t followed = 0, const SearchObserver& observer = {},
                   std::span<const Pose> more = {});

/// After locate(), to its candidates: those some decimetres beside the best of them, across the surfaces in
/// view. A wall and a window's pane behind it fit each other so well that the wrong one can cost less.
void lookBeside(Refiner& refiner, const RefineSettings& settings, const Volume& volume, TrackResult& found);

/// Poses within some centimetres and degrees of where the camera may be, let down in the coarse model
/// `overview`: what locate() takes as `more`.
std::vector<Pose> narrowDown(Refiner& refiner, const RefineSettings& settings, const PreprocessPass& frame,
                             const Volume& overview, std::vector<Pose> places);

}  // namespace rosefusion
