// Finds a frame's pose. By the product's own method starts from a motion model, the swarm and a descent onto
// the surface compete, and a frame that fits worse than its predecessors is searched for again, more widely.
// The other methods of tracking.method are host/pose_method.h's.
#pragma once
#include <deque>

#include "host/frame.h"
#include "host/motion_model.h"
#include "host/pose_method.h"

namespace rosefusion {

/// One thread.
class Tracker {
 public:
  Tracker(Device& device, const Settings& settings, const Intrinsics& intrinsics, TemplateSet templates);

  /// Tells how the camera moved since the frame before, where another sensor knows. Called once for every
  /// frame: motions add up over frames that were lost, until accept(); one that is unknown ends their sum.
  void move(const std::optional<CameraMotion>& motion);
  /// Pose of the frame held by `frame`. Call accept() where it is believed.
  TrackResult track(const PreprocessPass& frame, const Volume& volume, double timestamp);
  /// The same for a lost camera, whose surroundings and keyframes are searched, and these places: poses
  /// within some centimetres and degrees of where it may be, narrowed down in the coarse `overview` first.
  TrackResult find(const PreprocessPass& frame, const Volume& volume, double timestamp,
                   const Volume& overview, std::vector<Pose> places);
  /// Tells that the frame at `timestamp` has this pose, and whether it was fused. True where that makes it a
  /// keyframe.
  bool accept(const Pose& world_from_camera, double timestamp, bool fused);
  /// Tells that the last track() or find() found no pose: from now on find() is to be called.
  void lose();
  bool isLost() const { return lost_; }
  /// From now on told of every iteration of the searches with particles.
  void observe(SearchObserver observer) { observer_ = std::move(observer); }
  /// Tells that the map was corrected: where the last accepted frame and the keyframes are now.
  void rebase(const Pose& world_from_last, std::span<const Pose> keyframes);
  const TemplateSet& templates() const { return search_.templates(); }
  /// Fit of the frame at a pose, over the overlap with the last accepted frame; every 8th pixel.
  PoseScore score(const PreprocessPass& frame, const Volume& volume, const Pose& world_from_camera) {
    return search_.score(frame, volume, world_from_camera, last_);
  }
  /// The last accepted pose; the identity before any.
  const Pose& last() const { return last_; }

 private:
  bool addKeyframe(const Pose& world_from_camera);
  void search(const PreprocessPass& frame, const Volume& volume, const Pose& start, TrackResult& result);
  /// Median cost of the last frames; none at the start and after a loss.
  std::optional<double> usualCost() const;
  /// `otherwise`, with as much of it replaced as the motion told since the last accepted frame knows better.
  Pose asTold(const Pose& otherwise) const;

  const Settings settings_;
  SwarmSearch search_;
  Refiner refiner_;
  std::unique_ptr<PoseMethod> other_method_;  ///< none: the product's own
  SearchObserver observer_;
  MotionModel motion_;
  std::optional<CameraMotion> told_;  ///< since the last accepted frame; see move()
  std::vector<Pose> keyframes_;       ///< fused poses, spread over the model
  bool lost_ = false;
  std::deque<double> costs_;  ///< of the last frames
  Pose last_ = Pose::Identity();
};

}  // namespace rosefusion
