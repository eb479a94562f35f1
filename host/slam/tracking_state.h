// What becomes of a frame: whether it has a pose, whether that is reported, and whether it is integrated. The
// state machine of tracking, without device and images.
//
//   Initialising -> Tracking           the first frame with depth
//   Tracking     -> Verifying | Lost   a jump | no pose
//   Lost         -> Verifying          a pose that its image supports
//   Verifying    -> Tracking | Lost    enough consistent frames | one that fits nowhere
#pragma once
#include <optional>
#include <variant>

#include "host/core/trajectory.h"
#include "host/slam/relocalisation/pose_verification.h"
#include "host/slam/status_reason.h"
#include "host/slam/tracking/track_history.h"

namespace rosefusion {

/// Relocalised: found in the model after a loss, where two frames are consistent, or after a sudden change;
/// not integrated until the next frames are.
enum class TrackingStatus { Tracked, Uncertain, Relocalised, Lost };
const char* toString(TrackingStatus status);

/// There is no model yet.
struct Initialising {};
struct Tracking {
  TrackHistory history;
  bool occluded = false;  ///< something came before the camera
};
/// One image may match a wrong place, consecutive ones rarely do: tentative poses, from a first one that
/// nothing else supports. After a loss they are reported from the 2nd consistent frame (3rd if none has high
/// confidence) and integrated from the 3rd; after a jump reported at once and integrated from the 3rd. With
/// little map overlap they are reported from the 10th, since an unknown occluder would match anything, and
/// integrated once the camera has moved on and contradicts next to nothing.
struct Verifying {
  TrackHistory candidate;  ///< with the tentative poses
  TrackHistory before;     ///< what holds again if they are rejected
  bool occluded = false;   ///< as it was before
  int consistent = 0;      ///< frames in turn
  bool after_loss = false;
  bool high_confidence = false, overlap = false, confident_overlap = false;  ///< of one of these frames
  Pose first = Pose::Identity();                                             ///< of them
  Trajectory unreported;  ///< the poses of these frames that were not reported
};
struct Lost {
  TrackHistory before;
};
using TrackingState = std::variant<Initialising, Tracking, Verifying, Lost>;

/// What decides, in one place; the first eight are settings.
struct Thresholds {
  double min_valid_share, uncertain_overlap, uncertain_residual, lost_residual;
  double relocalised_share, intruding_share, least_constraint;
  double uncertain_deviation;  ///< metres
  bool relocalises;            ///< PoseMethod::relocalises()

  /// Of least_constraint, what holds a pose firmly. The noise of colours feigns slopes: worked out for a
  /// model of one image of a white wall, 3 m away, it seems to hold the pose by 4 times.
  double weak_constraint = kWeakConstraint, weak_constraint_with_colour = 5;
  /// Of intruding_share, at most, where what came before the camera is gone.
  double gone = kIntrudingWhenFound;
  double share_of_next = kShareOfNext;  ///< of relocalised_share
  /// What no search brings this close to the median cost is a jump. Right poses of flights and recordings
  /// exceed it by up to 0.21, a wrong one after 30 missing frames by 0.42
  /// (tests/bench/notes/relocalisation.md#found-where-its-motion-leads-and-slides-that-show).
  double jump_excess = 0.3;
  /// What the model knows of the view does not shrink by more from one frame to the next: of 66 000 tracked
  /// frames one lost 0.38 of it and no other 0.2; a hand takes a half, and may fit a wall elsewhere
  /// (tests/bench/notes/relocalisation.md).
  double suddenly_unknown = 0.3;
  /// Consistent frames. Where little is known up to 6 agreed on places half a metre off (room 1108,
  /// tests/bench/notes/relocalisation.md#another-processor-and-a-tentative-pose).
  int reported_at = 2, integrated_at = 3, reported_unknown_at = 10;
};
Thresholds thresholdsOf(const Settings& settings, bool relocalises);

/// What one frame's image says.
struct FrameEvidence {
  double timestamp = 0;
  PoseScore score;                       ///< at the pose found; where none was looked for, at the last one
  std::optional<TrackResult> found;      ///< none without a model, or with too little depth
  std::optional<VerifiedPose> verified;  ///< where mustVerify() and a pose is accepted
  double violation = 0;                  ///< share of the pixels in free space, at the pose found
};

struct Decision {
  TrackingState next;
  TrackingStatus status = TrackingStatus::Lost;
  StatusReason reason;
  std::optional<Pose> pose;  ///< world_from_camera, to be reported; none when lost
  bool integrate = false;
  Trajectory recovered;  ///< of the frames before: tentative poses that this one confirms
};

/// What the numbers alone say of a pose that was followed.
struct Judgement {
  TrackingStatus status = TrackingStatus::Tracked;
  StatusReason reason;
};
Judgement judge(const PoseScore& score, const Thresholds& thresholds);

/// Whether nothing but its own image speaks for the pose: the camera was lost, or it jumped.
bool isUnsure(const TrackingState& state, const TrackResult& found, double timestamp, const Thresholds&);
/// Whether it is accepted by what verifyPose() says, rather than by judge().
bool mustVerify(const TrackingState& state, const TrackResult& found, double timestamp, const Thresholds&);

/// `state`: with the frame's odometry added.
Decision decide(const TrackingState& state, const FrameEvidence& evidence, const Thresholds& thresholds);

/// What the next frame's pose is found from, tentative poses included; of no frames while Initialising.
const TrackHistory& historyOf(const TrackingState& state);
/// The last pose that was not tentative; the identity before any.
Pose acceptedPose(const TrackingState& state);

void addOdometry(TrackingState& state, const std::optional<CameraMotion>& motion);
/// The frame's pose is known.
TrackingState accepted(const TrackingState& state, const Pose& world_from_camera, double timestamp);
/// The frame has no pose.
TrackingState withoutPose(const TrackingState& state, const Thresholds& thresholds);
/// The map was corrected: where the last frame is now.
void move(TrackingState& state, const Pose& world_from_last);

}  // namespace rosefusion
