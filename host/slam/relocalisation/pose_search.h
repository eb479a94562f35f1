// Where in a model a frame was taken, when little is known about it.
#pragma once
#include <span>

#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

/// Around each centre a wide swarm is scanned; the best few are searched and refined onto the surface. The
/// result's fit counts every valid pixel, also what the model does not hold.
/// The first `followed` centres, where the camera is expected, are followed however others compare.
/// `more`: further poses, within some centimetres of where the camera may be, that are refined too; then of
/// the other centres only the best is searched.
TrackResult searchAround(SwarmSearch& search, PoseRefiner& refiner, const RefineSettings& settings,
                         const DeviceFrame& frame, const Volume& volume, std::span<const Pose> centres,
                         std::size_t followed = 0, const SearchObserver& observer = {},
                         std::span<const Pose> more = {});

/// After searchAround(), to its candidates: those some decimetres beside the best of them, across the
/// surfaces in view. A wall and a window's pane behind it fit each other so well that the wrong one can cost
/// less.
void searchAlongNormals(PoseRefiner& refiner, const RefineSettings& settings, const Volume& volume,
                        TrackResult& found);

/// Poses within some centimetres and degrees of where the camera may be, refined onto the surface of the
/// coarse map `coarse`: what searchAround() takes as `more`.
std::vector<Pose> alignCoarsely(PoseRefiner& refiner, const RefineSettings& settings,
                                const DeviceFrame& frame, const Volume& coarse, std::vector<Pose> places);

}  // namespace rosefusion
