// The paper's pose search and those it is compared with, behind one interface: each finds a frame's pose from
// the last frame's, in the same volume. Which one is tracking.method's choice, made here and nowhere else.
#pragma once
#include <memory>
#include <optional>

#include "host/refiner.h"
#include "host/search_observer.h"
#include "host/swarm_search.h"

namespace rosefusion {

struct TrackResult {
  Pose world_from_camera = Pose::Identity();
  int iterations = 0;
  std::uint64_t lookups = 0;        ///< TSDF voxels read; of icp the pixels paired
  std::optional<PoseFit> fit;       ///< where the descent ended; empty without it
  std::vector<PoseFit> candidates;  ///< of a search of the whole model: distinct poses, least cost first
  bool doubtful = false;            ///< fits far worse than the frames before it, or came long after them
};

/// One thread.
class PoseMethod {
 public:
  virtual ~PoseMethod() = default;
  /// Pose of the frame held by `frame`, searched from `last`, the last frame's. The searches with particles
  /// tell `observer` of every iteration.
  virtual TrackResult track(const PreprocessPass& frame, const Volume& volume, const Pose& last,
                            const SearchObserver& observer = {}) = 0;
};

/// None for method default, which is Tracker's own. `search` and `refiner` must outlive the result.
std::unique_ptr<PoseMethod> makePoseMethod(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, SwarmSearch& search,
                                           Refiner& refiner);

}  // namespace rosefusion
