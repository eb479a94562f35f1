// Why a frame has its status.
#pragma once
#include <iosfwd>
#include <string>

namespace rosefusion {

enum class Reason {
  None,                ///< tracked
  LittleDepth,         ///< share: of the pixels with valid depth
  NoOverlap,           ///< with the last frame
  LittleOverlap,       ///< share: of the pixels
  PoorFit,             ///< share: the residual, of the truncation
  Unconstrained,       ///< a direction
  WeaklyConstrained,   ///< a direction
  NotVerified,         ///< of a lost camera, or after a jump: no pose
  Tentative,           ///< relocalised, not yet reported
  ConfirmedLater,      ///< relocalised by the frames after it
  Jump,                ///< reported, not yet integrated, as are the next two
  ConsistentOnce,      ///< relocalised; one more frame is awaited
  ConsistentUnknown,   ///< relocalised where little of the view is known
  Occluded,            ///< share: of the pixels in known free space
  OccludedAndNotHeld,  ///< share: the same; the rest of the image holds no pose
  InDetachedMap,       ///< tracked in a map of its own, which is not connected to the first
  Joined,              ///< the same, and connected by a later frame
  ModelBegunAnew,      ///< after the frame, and without it
};

/// A reason and the number that goes with it.
struct StatusReason {
  Reason reason = Reason::None;
  double share = 0;

  bool operator==(Reason other) const { return reason == other; }
};

/// A sentence's words without full stop; empty for None.
std::string toString(const StatusReason& reason);
std::ostream& operator<<(std::ostream& out, const StatusReason& reason);

}  // namespace rosefusion
