// Finds a lost camera: searches where it is expected, around keyframes, and where planes of the view lie on
// planes of the map, and refines what it finds onto the surface.
#pragma once
#include "host/slam/mapping/map.h"
#include "host/slam/relocalisation/plane_alignment.h"
#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"
#include "host/slam/tracking/track_history.h"

namespace rosefusion {

/// One thread.
class Relocaliser {
 public:
  /// `search` and `refiner` must outlive it.
  Relocaliser(const RefineSettings& settings, SwarmSearch& search, PoseRefiner& refiner)
      : settings_(settings), search_(search), refiner_(refiner) {}

  /// Poses of the frame held by `frame`, whose image is `metres` (of depthInMetres()), taken at `timestamp`;
  /// candidates by cost. `before`: of the frames before the loss. Whether one is accepted is for
  /// pose_verification.h to say.
  TrackResult find(const DeviceFrame& frame, const cv::Mat& metres, const Map& map,
                   const TrackHistory& before, double timestamp, const SearchObserver& observer = {});

 private:
  const RefineSettings settings_;
  SwarmSearch& search_;
  PoseRefiner& refiner_;
  std::size_t searched_ = 0;  ///< keyframes so far
};

}  // namespace rosefusion
