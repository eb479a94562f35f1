// Finds a lost camera: searches where it is expected, around keyframes, and where planes of the view lie on
// planes of the map, and refines what it finds onto the surface.
#pragma once
#include "host/slam/mapping/coarse_map.h"
#include "host/slam/mapping/free_space.h"
#include "host/slam/relocalisation/plane_alignment.h"
#include "host/slam/tracking/tracker.h"

namespace rosefusion {

/// One thread.
class Relocaliser {
 public:
  /// Searches with the tracker's swarm and refiner; the tracker must outlive it.
  Relocaliser(const Settings& settings, Tracker& tracker) : settings_(settings), tracker_(tracker) {}

  /// Offers a pose that was fused as a keyframe: true where it becomes one, being far from the others.
  bool addKeyframe(const Pose& world_from_camera);
  /// Tells that the map was corrected: where the keyframes are now.
  void rebase(std::span<const Pose> keyframes);
  /// Poses of the frame held by `frame`, whose image is `depth` (see Frame::depth); candidates by cost.
  /// Whether one may be believed is for pose_verification.h to say.
  TrackResult find(const PreprocessPass& frame, const cv::Mat& depth, const Volume& volume,
                   const CoarseMap& coarse, const KnownFreeSpace& free_space, double timestamp);

 private:
  const Settings settings_;
  Tracker& tracker_;
  std::vector<Pose> keyframes_;  ///< fused poses, spread over the model
  std::size_t searched_ = 0;     ///< keyframes so far
};

}  // namespace rosefusion
