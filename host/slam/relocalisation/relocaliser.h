// Finds a lost camera: searches where it is expected, around keyframes, and where planes of the view lie on
// planes of the map, and refines what it finds onto the surface.
#pragma once
#include "host/slam/mapping/coarse_map.h"
#include "host/slam/mapping/free_space.h"
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

  /// Offers a pose that was fused as a keyframe: true where it becomes one, being far from the others.
  bool addKeyframe(const Pose& world_from_camera);
  /// Tells that the map was corrected: where the keyframes are now.
  void rebase(std::span<const Pose> keyframes);
  /// Poses of the frame held by `frame`, whose image is `depth` (see Frame::depth), taken at `timestamp`;
  /// candidates by cost. `before`: of the frames before the loss. Whether one is accepted is for
  /// pose_verification.h to say.
  TrackResult find(const PreprocessPass& frame, const cv::Mat& depth, const Volume& volume,
                   const CoarseMap& coarse, const KnownFreeSpace& free_space, const TrackHistory& before,
                   double timestamp, const SearchObserver& observer = {});

 private:
  const RefineSettings settings_;
  SwarmSearch& search_;
  PoseRefiner& refiner_;
  std::vector<Pose> keyframes_;  ///< fused poses, spread over the model
  std::size_t searched_ = 0;     ///< keyframes so far
};

}  // namespace rosefusion
