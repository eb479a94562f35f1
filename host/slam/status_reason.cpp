#include "host/slam/status_reason.h"

#include <cstdio>
#include <ostream>

namespace rosefusion {
namespace {

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

}  // namespace

std::string toString(const StatusReason& why) {
  switch (why.reason) {
    case Reason::None:
      return "";
    case Reason::LittleDepth:
      return "only " + percent(why.share) + " of the pixels have valid depth";
    case Reason::NoOverlap:
      return "no pixel overlaps the last frame";
    case Reason::LittleOverlap:
      return "only " + percent(why.share) + " of the pixels overlap the last frame";
    case Reason::PoorFit:
      return "the depth misses the model by " + percent(why.share) + " of the truncation";
    case Reason::Unconstrained:
      return "the depth leaves a direction open, as a flat wall does; past motion holds it";
    case Reason::WeaklyConstrained:
      return "the depth hardly holds a direction, as before a nearly flat wall; the pose may drift there";
    case Reason::NotVerified:
      return "no pose could be verified";
    case Reason::Tentative:
      return "relocalised tentatively; reported after the next consistent frame";
    case Reason::ConfirmedLater:
      return "found tentatively; the frames after it are consistent with it";
    case Reason::Jump:
      return "a sudden change; integrated once the next frames are consistent with it";
    case Reason::ConsistentOnce:
      return "consistent with the frame before; integrated once one more is";
    case Reason::ConsistentUnknown:
      return "consistent with the frame before; integrated once more of the view is known";
    case Reason::Occluded:
      return "something came before the camera (" + percent(why.share) +
             " of the image); not integrated until it is gone";
    case Reason::OccludedAndNotHeld:
      return "something came before the camera (" + percent(why.share) + " of the image) and hides the scene";
    case Reason::InDetachedMap:
      return "followed in a map of its own, until a place connects it to the first map";
    case Reason::Joined:
      return "followed in a map of its own, which a later frame connected to the first map";
    case Reason::ModelBegunAnew:
      return "the model was begun anew after it";
  }
  return "";
}

std::ostream& operator<<(std::ostream& out, const StatusReason& reason) {
  return out << toString(reason);
}

}  // namespace rosefusion
