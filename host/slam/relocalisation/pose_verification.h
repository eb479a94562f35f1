// Whether a pose found for a lost camera, or after a jump, is accepted: what one image must show for it. How
// many must agree is for tracking_state.h to say.
#pragma once
#include <optional>

#include "host/slam/mapping/free_space.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

/// Fraction of tracking.relocalised_share that suffices once the previous frame supports the pose.
inline constexpr double kShareOfNext = 0.5;
/// Whether what intruded is gone, of tracking.intruding_share.
inline constexpr double kIntrudingWhenFound = 0.5;

/// Metres and radians: two poses that differ by less are one place, and no two that look alike.
inline constexpr double kElsewhere = 0.3;

/// A fit that everything seen supports.
struct VerifiedPose {
  PoseFit fit;
  bool high_confidence = false;  ///< contradicts next to nothing that was seen before
};

/// What a pose must show where nothing else supports it.
struct AcceptanceThresholds {
  double inlier_ratio;  ///< of the pixels that read a distance, at least
  /// Share of the pixels in known free space, at most, where next to all of the view is known.
  double free_space;
};

/// Inlier ratio of the frames that were fused: how a camera and a scene do is not known beforehand.
class InlierStatistics {
 public:
  /// Of a frame that was fused.
  void add(const PoseFit& fit);
  /// Close to the running statistics when relocalising; the fixed minimum when tracking, where new surfaces
  /// lower the ratio.
  AcceptanceThresholds thresholds(bool relocalising, double intruding_share) const;

 private:
  int frames_ = 0;
  double mean_ = 0, variance_ = 0;  ///< of the inlier ratio, the last fifty frames counting most
};

/// Of the poses found, least cost first, the one that everything seen supports: the image (of
/// depthInMetres()) shows the surfaces that should be there and none in known free space. None where two
/// distinct poses would do. `unsure`: nothing else supports it; then it must meet `thresholds`.
std::optional<VerifiedPose> verifyPose(const Settings& settings, const KnownFreeSpace& free_space,
                                       const cv::Mat& depth, const TrackResult& found, bool unsure,
                                       const AcceptanceThresholds& thresholds);

}  // namespace rosefusion
