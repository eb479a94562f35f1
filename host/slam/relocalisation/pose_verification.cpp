#include "host/slam/relocalisation/pose_verification.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

// Of what reads a distance. Tracked frames of recordings have 0.84 and more, 99 % of them 0.88; wrong places
// in an office with many alike 0.83 and less
// (tests/bench/notes/relocalisation.md#a-lost-camera-placed-by-planes).
constexpr double kInlierRatioWhenFound = 0.85;
// In generated rooms, where fused frames differ by 0.002, right places have at most 0.015 less of it than is
// usual, wrong ones of which much is known 0.025 and more; in freiburg1_rpy frames differ by 0.02
// (tests/bench/notes/relocalisation.md#what-contradicts-a-place-both-ways).
constexpr double kLessInliers = 0.02, kDeviations = 3, kNewest = 0.02;
// High confidence. Where a pose contradicts nothing that was seen, less of the image need be known: right
// poses of kidnapped flights have .97, .06 and .2 of these at worst, wrong ones .96, .2 and 1 at best
// (tests/bench/notes/relocalisation.md#what-contradicts-a-place-both-ways).
constexpr struct {
  double inlier_ratio, free_space, missing;  ///< the last two as shares of tracking.intruding_share
  double share;                              ///< then asked for, of what is asked for otherwise
} kConfident{0.95, 0.2, 0.4, 0.6};
// Edges that a camera smears lie in space seen to be empty: of right poses of freiburg1_rpy up to 0.038 of
// the image, of which 0.96 is known, and as much is not close to a surface in a usual frame.
constexpr double kMostlyKnown = 0.8;

}  // namespace

void InlierStatistics::add(const PoseFit& fit) {
  if (fit.observed_ratio <= 0) return;
  const double weight = std::max(1.0 / ++frames_, kNewest),
               off = fit.inlier_ratio / fit.observed_ratio - mean_;
  mean_ += weight * off;
  variance_ = (1 - weight) * (variance_ + weight * off * off);
}

AcceptanceThresholds InlierStatistics::thresholds(bool relocalising, double intruding_share) const {
  AcceptanceThresholds out{kInlierRatioWhenFound, kIntrudingWhenFound * intruding_share};
  if (!relocalising || frames_ == 0) return out;
  out.inlier_ratio =
      std::max(out.inlier_ratio, mean_ - std::max(kLessInliers, kDeviations * std::sqrt(variance_)));
  out.free_space = std::clamp(1 - mean_, out.free_space, intruding_share);
  return out;
}

std::optional<VerifiedPose> verifyPose(const Settings& settings, const KnownFreeSpace& free_space,
                                       const cv::Mat& depth, const TrackResult& found, bool unsure,
                                       const AcceptanceThresholds& thresholds) {
  const double intruding = settings.tracking.intruding_share;
  // A frame that is consistent with the one found before it may see more that is new.
  const double share = (unsure ? 1 : kShareOfNext) * settings.tracking.relocalised_share;
  const double observability = kWeakConstraint * settings.refine.least_constraint;
  std::optional<VerifiedPose> verified;
  const auto consider = [&](const PoseFit& fit) {
    const Pose& pose = fit.world_from_camera;
    if (!fit.holds(kConfident.share * share, observability)) return true;
    if (unsure && fit.inlier_ratio < thresholds.inlier_ratio * fit.observed_ratio) return true;
    const double violation = free_space.violation(depth, pose);
    if (violation >
        (fit.observed_ratio < kMostlyKnown ? kIntrudingWhenFound * intruding : thresholds.free_space))
      return true;
    const double missing = free_space.missingSurface(depth, pose);
    if (missing > intruding) return true;
    const bool confident = fit.inlier_ratio >= kConfident.inlier_ratio * fit.observed_ratio &&
                           violation <= kConfident.free_space * intruding &&
                           missing <= kConfident.missing * intruding;
    if (!confident && fit.observed_ratio < share) return true;
    if (!verified) verified = {fit, confident};
    return areNear(verified->fit.world_from_camera, pose, kElsewhere, kElsewhere);
  };
  if (found.candidates.empty()) {
    consider(*found.fit);
    return verified;
  }
  const bool alone = std::all_of(found.candidates.begin(), found.candidates.end(), consider);
  return alone ? verified : std::nullopt;
}

}  // namespace rosefusion
