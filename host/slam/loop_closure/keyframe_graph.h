// Where keyframes are, how they hang together, and where all frames between them are. Pure: no device, no
// images.
#pragma once
#include <functional>
#include <optional>

#include "host/settings/settings.h"
#include "host/slam/loop_closure/pose_graph.h"

namespace rosefusion {

/// The way travelled counts a radian as much as a metre. One thread.
class KeyframeGraph {
 public:
  explicit KeyframeGraph(const LoopSettings& settings) : settings_(settings) {}

  /// Hangs a frame onto the keyframe that it followed. True where it is a keyframe itself, which only a fused
  /// frame can be. `well_constrained`: the depth held it in every direction.
  bool add(const Pose& world_from_camera, bool fused, bool well_constrained);
  /// The camera was lost: the next frames hang onto the keyframe nearest to where they were found.
  void onTrackingLost() { broken_ = true; }

  /// Whether the newest keyframe shares `least` with one that was passed loops.min_travel before.
  bool overlapsOld(double least, const std::function<double(std::size_t)>& overlap) const;

  std::size_t size() const { return keyframes_.size(); }
  const Pose& pose(std::size_t keyframe) const { return keyframes_[keyframe].world_from_camera; }
  double travelled() const { return travelled_; }

  /// Among the keyframes passed loops.min_travel before, the one with the most to compare the newest with;
  /// `overlap` says which share of it that is, `usable` which may be chosen. Where none has enough, the
  /// closest in place and view, if any is within loops.reach: drift may have hidden what they share.
  std::optional<std::size_t> candidate(const std::function<bool(std::size_t)>& usable,
                                       const std::function<double(std::size_t)>& overlap) const;
  /// Keyframes that came shortly before and after this one and look about the same way, itself included.
  std::vector<std::size_t> neighbours(std::size_t keyframe,
                                      const std::function<bool(std::size_t)>& usable) const;

  /// The newest keyframe's pose, measured against an old one; `sure`: by most of its image.
  PoseEdge constraintTo(std::size_t old, const Pose& world_from_newest, bool sure = true) const;
  /// Counts from the next close() on.
  void addConstraint(const PoseEdge& edge) { constraints_.push_back(edge); }
  /// Moves all keyframes to where the edges want them; false, and nothing is changed, where the newest loop
  /// constraints contradict older ones or well constrained tracking. Then they are forgotten. `way`: poses of
  /// the newest keyframes, the last one included, whose motions replace the tracked ones.
  bool close(std::span<const Pose> way = {});
  /// Poses of all frames added, in their order, as they are known now.
  std::vector<Pose> framePoses() const;

 private:
  struct Keyframe {
    Pose world_from_camera;
    double travelled;
  };
  struct AttachedFrame {
    std::size_t keyframe;
    Pose keyframe_from_camera;
  };
  std::size_t nearest(const Pose& world_from_camera) const;

  const LoopSettings settings_;
  std::vector<Keyframe> keyframes_;
  std::vector<PoseEdge> edges_, constraints_;
  std::size_t closed_constraints_ = 0;  ///< of constraints_, those that close() has moved the keyframes to
  std::vector<AttachedFrame> frames_;
  Pose last_ = Pose::Identity();
  double travelled_ = 0;
  bool broken_ = false;
  double weak_path_ =
      0;  ///< of what was travelled since the last keyframe, what weakly constrained frames made
};

}  // namespace rosefusion
