// The product's own way to find a frame's pose: starts from a motion model, the swarm and the refinement onto
// the surface compete, and a frame that fits worse than its predecessors is searched for again, more widely.
#pragma once
#include "host/slam/tracking/pose_method.h"
#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

class Tracker : public PoseMethod {
 public:
  /// `search` and `refiner` must outlive it.
  Tracker(const RefineSettings& settings, SwarmSearch& search, PoseRefiner& refiner)
      : settings_(settings), search_(search), refiner_(refiner) {}

  TrackResult track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history,
                    double timestamp, const SearchObserver& observer = {}) override;
  bool relocalises() const override { return true; }

 private:
  const RefineSettings settings_;
  SwarmSearch& search_;
  PoseRefiner& refiner_;
};

}  // namespace rosefusion
