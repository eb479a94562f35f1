// What became of one frame.
#pragma once
#include <optional>
#include <vector>

#include "host/core/trajectory.h"
#include "host/slam/loop_closure/loop_closer.h"
#include "host/slam/tracking_state.h"

namespace rosefusion {

struct StageMilliseconds {
  double total = 0;
  double preprocess = 0;
  double track = 0;
  double integrate = 0;
  double loops = 0;
};

/// A pose that is inserted into Pipeline::trajectory(): those from its number on come one later.
struct RecoveredPose {
  std::size_t number = 0;
  StampedPose pose;
  Reason reason = Reason::None;
};

/// Detached map `map` is now part of map `into`.
struct JoinedMap {
  std::size_t map = 0, into = 1;
};

struct FrameResult {
  double timestamp = 0;
  /// World = the camera of the first fused frame. When lost: the last pose that was tracked or uncertain.
  Pose world_from_camera = Pose::Identity();
  TrackingStatus status = TrackingStatus::Lost;
  StatusReason reason;
  PoseScore score;             ///< the numbers behind the status
  std::optional<PoseFit> fit;  ///< and those of the descent, where there was one
  /// Share of the valid pixels in space that the last fused frame saw to be empty: something has come before
  /// the camera, or the pose is wrong.
  double intruding = 0;
  bool fused = false;
  /// The model begins anew with the frame before this one, whose pose is the identity; what it held until
  /// then fits neither. All poses told before are void.
  bool began_anew = false;
  /// Its pose in Pipeline::trajectory(); none when lost.
  std::optional<std::size_t> number;
  /// Closed at this frame: all earlier poses have changed; see Pipeline::trajectory().
  std::optional<LoopClosure> loop;
  /// Poses of frames before, which were lost when they came and are known since this one; to be inserted one
  /// after the other, before `number` counts.
  std::vector<RecoveredPose> recovered;
  /// The frame has no pose in the first map, but one in this one, which is not connected to it yet.
  std::optional<std::size_t> detached_map;
  /// That map begins anew with the frame before this one, as the first does with `began_anew`.
  bool detached_began_anew = false;
  /// Maps that this frame connects. The poses of those that come to the first, number 1, are in `recovered`.
  std::vector<JoinedMap> joined;
  /// The camera is held again: poses of frames before, which depth had left open, have changed; see
  /// Pipeline::trajectory().
  bool stretch_closed = false;
  int iterations = 0;
  std::uint64_t lookups = 0;
  StageMilliseconds milliseconds;
};

}  // namespace rosefusion
