// Whether a pose found for a lost camera, or after a jump, is accepted: what one image must show for it, and
// how many consistent images it takes before it is reported and integrated.
#pragma once
#include <optional>

#include "host/slam/mapping/free_space.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

/// Fraction of tracking.relocalised_share that suffices once the previous frame supports the pose.
inline constexpr double kShareOfNext = 0.5;
/// Whether what intruded is gone, of tracking.intruding_share.
inline constexpr double kIntrudingWhenFound = 0.5;

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

/// Of the poses found, least cost first, the one that everything seen supports: the image (as Frame::depth)
/// shows the surfaces that should be there and none in known free space. None where two distinct poses would
/// do. `unsure`: nothing else supports it; then it must meet `thresholds`.
std::optional<VerifiedPose> verifyPose(const Settings& settings, const KnownFreeSpace& free_space,
                                       const cv::Mat& depth, const TrackResult& found, bool unsure,
                                       const AcceptanceThresholds& thresholds);

/// One image may match a wrong place, consecutive ones rarely do. After a loss a pose is reported from the
/// 2nd consistent frame (3rd if none has high confidence) and integrated from the 3rd. After a jump it is
/// reported at once and integrated from the 3rd. With little map overlap it is reported from the 10th and
/// never integrated: an unknown occluder would match anything.
class TemporalVerification {
 public:
  enum class Standing {
    Rejected,
    Tentative,   ///< not to be reported
    Consistent,  ///< not to be integrated
    Confirmed
  };

  /// Whether the frames so far await more that are consistent with them.
  bool isPending() const { return consistent_ > 0; }
  /// Whether one of the consistent frames showed tracking.relocalised_share of what is known.
  bool hasOverlap() const { return overlap_; }
  /// After a frame that was unsure, or while isPending(). `verified`: what verifyPose() says of it. `lost`:
  /// that the frame before it had no pose.
  Standing next(const std::optional<VerifiedPose>& verified, double relocalised_share, bool unsure,
                bool lost);
  void end() { consistent_ = 0; }

 private:
  int consistent_ = 0;  ///< frames in turn, since one that was unsure
  bool high_confidence_ = false, overlap_ = false, confident_overlap_ = false;  ///< one of them
  bool was_lost_ = false;
};

}  // namespace rosefusion
