// Finds a frame's pose. By the product's own method starts from a motion model, the swarm and the refinement
// onto the surface compete, and a frame that fits worse than its predecessors is searched for again, more
// widely. The other methods of tracking.method take its place: replaceBy().
#pragma once
#include <deque>

#include "host/core/frame.h"
#include "host/slam/tracking/motion_model.h"
#include "host/slam/tracking/pose_method.h"
#include "host/slam/tracking/pose_refiner.h"
#include "host/slam/tracking/swarm_search.h"

namespace rosefusion {

/// One thread.
class Tracker {
 public:
  Tracker(Device& device, const Settings& settings, const Intrinsics& intrinsics, TemplateSet templates);
  /// Poses are found by another method from now on, which never loses the camera; null: by its own.
  void replaceBy(std::unique_ptr<PoseMethod> method) { other_method_ = std::move(method); }
  bool isReplaced() const { return other_method_ != nullptr; }

  /// Odometry since the frame before, where another sensor has it. Called once for every frame: motions are
  /// composed across lost frames until accept(); a frame without one discards their sum.
  void addOdometry(const std::optional<CameraMotion>& motion);
  /// Pose of the frame held by `frame`. Call accept() where it is verified.
  TrackResult track(const PreprocessPass& frame, const Volume& volume, double timestamp);
  /// Where a lost camera may be, for all that is known of its motion: of `poses` the first `followed` are
  /// worth a closer look than others.
  struct Expected {
    std::vector<Pose> poses;
    std::size_t followed;
  };
  Expected expectedPoses(double timestamp) const;
  /// Tells that the frame at `timestamp` has this pose.
  void accept(const Pose& world_from_camera, double timestamp);
  /// The same for a pose that the next frames must confirm: they are tracked from it, and setLost() before
  /// accept() restores the state before it.
  void setTentative(const Pose& world_from_camera, double timestamp);
  /// Tells that no pose was found: from now on the camera is to be relocalised.
  void setLost();
  bool isLost() const { return state_.lost; }
  /// Tells that the model begins anew: what was tracked before is forgotten.
  void reset() {
    state_ = {};
    before_tentative_.reset();
  }
  /// From now on told of every iteration of the searches with particles.
  void observe(SearchObserver observer) { observer_ = std::move(observer); }
  const SearchObserver& observer() const { return observer_; }
  /// Tells that the map was corrected: where the last accepted frame is now.
  void rebase(const Pose& world_from_last);
  /// What poses are searched with, for others on the same frame.
  SwarmSearch& swarmSearch() { return search_; }
  PoseRefiner& refiner() { return refiner_; }
  const TemplateSet& templates() const { return search_.templates(); }
  /// Fit of the frame at a pose, over the overlap with the last accepted or tentative frame; every 8th pixel.
  PoseScore score(const PreprocessPass& frame, const Volume& volume, const Pose& world_from_camera) {
    return search_.score(frame, volume, world_from_camera, state_.last);
  }
  /// The last accepted pose; the identity before any.
  const Pose& last() const { return (before_tentative_ ? *before_tentative_ : state_).last; }

 private:
  /// What the frames so far tell about the next.
  struct TrackState {
    MotionModel motion;
    std::optional<CameraMotion> odometry;  ///< since `last`; see addOdometry()
    std::deque<double> costs;              ///< of the last frames
    std::optional<double> observed_ratio;  ///< of the last frame; none after a loss
    Pose last = Pose::Identity();
    bool lost = false;

    void addOdometry(const std::optional<CameraMotion>& by);
    void advance(const Pose& world_from_camera, double timestamp);
    void rebase(const Pose& new_from_old_world);
  };

  void search(const PreprocessPass& frame, const Volume& volume, const Pose& start, TrackResult& result);
  /// Median cost of the last frames; none at the start and after a loss.
  std::optional<double> medianCost() const;
  /// `otherwise`, with as much of it replaced as the odometry since the last accepted frame knows.
  Pose withOdometry(const Pose& otherwise) const;

  const Settings settings_;
  SwarmSearch search_;
  PoseRefiner refiner_;
  std::unique_ptr<PoseMethod> other_method_;  ///< none: the product's own
  SearchObserver observer_;
  TrackState state_;
  std::optional<TrackState> before_tentative_;  ///< to restore if the tentative poses are rejected
};

}  // namespace rosefusion
