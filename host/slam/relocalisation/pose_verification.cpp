#include "host/slam/relocalisation/pose_verification.h"

#include <algorithm>
#include <cmath>

#include "host/slam/tracking/pose_refiner.h"

namespace rosefusion {
namespace {

// Of what reads a distance. Tracked frames of recordings have 0.84 and more, 99 % of them 0.88; wrong places
// in an office with many alike 0.83 and less (tests/bench/NOTES.md).
constexpr double kCloseWhenFound = 0.85;
// In generated rooms, where fused frames differ by 0.002, right places have at most 0.015 less of it than is
// usual, wrong ones of which much is known 0.025 and more; in freiburg1_rpy frames differ by 0.02
// (tests/bench/NOTES.md).
constexpr double kLessClose = 0.02, kDeviations = 3, kNewest = 0.02;
// Where a place contradicts nothing that was seen, less of the image need be known: right poses of kidnapped
// flights have .97, .06 and .2 of these at worst, wrong ones .96, .2 and 1 at best (tests/bench/NOTES.md).
constexpr struct {
  double close, through, missing;  ///< of what reads a distance; of tracking.intruding_share
  double share;                    ///< then asked for, of what is asked for otherwise
} kFirm{0.95, 0.2, 0.4, 0.6};
// Edges that a camera smears lie in space seen to be empty: of right poses of freiburg1_rpy up to 0.038 of
// the image, of which 0.96 is known, and as much is not close to a surface in a usual frame.
constexpr double kMostlyKnown = 0.8;
constexpr double kElsewhere = 0.3;  // metres and radians: two places that look alike are none
constexpr int kToldAt = 2, kFusedAt = 3;
// Where little is known: up to 6 frames agreed on places half a metre off (room 1108, tests/bench/NOTES.md).
constexpr int kToldUnknownAt = 10;

}  // namespace

void UsualFit::add(const PoseFit& fit) {
  if (fit.usable <= 0) return;
  const double weight = std::max(1.0 / ++frames_, kNewest), off = fit.close / fit.usable - mean_;
  mean_ += weight * off;
  variance_ = (1 - weight) * (variance_ + weight * off * off);
}

AskedOfPlace UsualFit::asked(bool searching, double intruding_share) const {
  AskedOfPlace out{kCloseWhenFound, kIntrudingWhenFound * intruding_share};
  if (!searching || frames_ == 0) return out;
  out.close = std::max(out.close, mean_ - std::max(kLessClose, kDeviations * std::sqrt(variance_)));
  out.through = std::clamp(1 - mean_, out.through, intruding_share);
  return out;
}

std::optional<Believed> believe(const Settings& settings, const SeenThrough& seen, const cv::Mat& depth,
                                const TrackResult& found, bool unsure, const AskedOfPlace& asked) {
  const double intruding = settings.tracking.intruding_share;
  // A frame that agrees with the one found before it may see more that is new.
  const double share = (unsure ? 1 : kShareOfNext) * settings.tracking.relocalised_share;
  const double constraint = kWeakConstraint * settings.refine.least_constraint;
  std::optional<Believed> believed;
  const auto consider = [&](const PoseFit& fit) {
    const Pose& pose = fit.world_from_camera;
    if (!fit.holds(kFirm.share * share, constraint)) return true;
    if (unsure && fit.close < asked.close * fit.usable) return true;
    const double through = seen.shareOfAll(depth, pose);
    if (through > (fit.usable < kMostlyKnown ? kIntrudingWhenFound * intruding : asked.through)) return true;
    const double missing = seen.shareMissing(depth, pose);
    if (missing > intruding) return true;
    const bool firm = fit.close >= kFirm.close * fit.usable && through <= kFirm.through * intruding &&
                      missing <= kFirm.missing * intruding;
    if (!firm && fit.usable < share) return true;
    if (!believed) believed = {fit, firm};
    return areNear(believed->fit.world_from_camera, pose, kElsewhere, kElsewhere);
  };
  if (found.candidates.empty()) {
    consider(*found.fit);
    return believed;
  }
  const bool alone = std::all_of(found.candidates.begin(), found.candidates.end(), consider);
  return alone ? believed : std::nullopt;
}

Confirmation::Standing Confirmation::next(const std::optional<Believed>& believed, double relocalised_share,
                                          bool unsure, bool lost) {
  if (!believed) {
    end();
    return Standing::Refused;
  }
  if (unsure) {
    was_lost_ = lost || isAwaited();
    agreed_ = 0;
    firm_ = knows_ = knows_firmly_ = false;
  }
  ++agreed_;
  const bool knows = believed->fit.usable >= relocalised_share;
  firm_ = firm_ || believed->firm;
  knows_ = knows_ || knows;
  knows_firmly_ = knows_firmly_ || (knows && believed->firm);
  if (was_lost_ && agreed_ < (knows_firmly_ ? kToldAt : knows_ ? kFusedAt : kToldUnknownAt))
    return Standing::Supposed;
  if (!knows_ || agreed_ < kFusedAt || (firm_ && !believed->firm)) return Standing::Agreeing;
  end();
  return Standing::Confirmed;
}

}  // namespace rosefusion
