// Where keyframes are, how they hang together, and where all frames between them are. Pure: no device, no
// images.
#pragma once
#include <functional>
#include <optional>

#include "host/settings/settings.h"
#include "host/slam/loop_closure/pose_graph.h"

namespace rosefusion {

/// The way travelled counts a radian as much as a metre. One thread.
class KeyframeMap {
 public:
  explicit KeyframeMap(const LoopSettings& settings) : settings_(settings) {}

  /// Hangs a frame onto the keyframe that it followed. True where it is a keyframe itself, which only a fused
  /// frame can be. `firm`: the depth held it in every direction.
  bool add(const Pose& world_from_camera, bool fused, bool firm);
  /// The camera was lost: the next frames hang onto the keyframe nearest to where they were found.
  void breakOff() { broken_ = true; }

  /// Whether the newest keyframe shares `least` with one that was passed loops.min_travel before.
  bool meetsOld(double least, const std::function<double(std::size_t)>& overlap) const;

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
  PoseEdge tieOf(std::size_t old, const Pose& world_from_newest, bool sure = true) const;
  /// Counts from the next close() on.
  void tie(const PoseEdge& edge) { ties_.push_back(edge); }
  /// Moves all keyframes to where the edges want them; false, and nothing is changed, where the newest ties
  /// contradict older ones or what was tracked firmly. Then they are forgotten. `way`: poses of the newest
  /// keyframes, the last one included, whose motions replace the tracked ones.
  bool close(std::span<const Pose> way = {});
  /// Poses of all frames added, in their order, as they are known now.
  std::vector<Pose> framePoses() const;

 private:
  struct Keyframe {
    Pose world_from_camera;
    double travelled;
  };
  struct HungFrame {
    std::size_t keyframe;
    Pose keyframe_from_camera;
  };
  std::size_t nearest(const Pose& world_from_camera) const;

  const LoopSettings settings_;
  std::vector<Keyframe> keyframes_;
  std::vector<PoseEdge> edges_, ties_;
  std::size_t closed_ties_ = 0;  ///< of ties_, those that close() has moved the keyframes to
  std::vector<HungFrame> frames_;
  Pose last_ = Pose::Identity();
  double travelled_ = 0;
  bool broken_ = false;
  double loose_way_ = 0;  ///< of what was travelled since the last keyframe, what frames not firm made
};

}  // namespace rosefusion
