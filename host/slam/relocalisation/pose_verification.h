// Whether a pose found for a lost camera, or after a sudden change, is believed: what one image must show for
// it, and how many images must agree before it is told and fused.
#pragma once
#include <optional>

#include "host/slam/mapping/free_space.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

/// Of tracking.relocalised_share: what a frame must know of its view where the frame before speaks for its
/// pose.
inline constexpr double kShareOfNext = 0.5;
/// Whether what intruded is gone, of tracking.intruding_share.
inline constexpr double kIntrudingWhenFound = 0.5;

struct Believed {
  PoseFit fit;
  bool firm = false;  ///< contradicts next to nothing that was seen before
};

/// What a place must show to be believed where nothing else speaks for it.
struct AskedOfPlace {
  double close;  ///< of what reads a distance, the share at least that must lie close to a surface
  /// Of the image, the share at most that may lie in space seen to be empty, where next to all of the image
  /// is known.
  double through;
};

/// How well the frames that are fused fit: how a camera and a scene do is not known beforehand.
class UsualFit {
 public:
  /// Of a frame that was fused.
  void add(const PoseFit& fit);
  /// While a camera is searched for, about what is usual; of one that is followed, which may see what is new,
  /// less.
  AskedOfPlace asked(bool searching, double intruding_share) const;

 private:
  int frames_ = 0;
  double mean_ = 0, variance_ = 0;  ///< of the share that is close, the last fifty frames counting most
};

/// Of the poses found, least cost first, the one that everything seen speaks for: the image (as Frame::depth)
/// shows what should be there and nothing where there was nothing. None where two places would do. `unsure`:
/// nothing else speaks for it; then its surfaces must be as close as is `asked`.
std::optional<Believed> believe(const Settings& settings, const SeenThrough& seen, const cv::Mat& depth,
                                const TrackResult& found, bool unsure, const AskedOfPlace& asked);

/// At times an image fits a wrong place, but the next hardly does: once lost or in doubt, three frames must
/// agree before one is fused, which is firm if one of the others was. Once lost, two before one is told, of
/// which one is firm and shows mostly what is known, else three. While none shows mostly what is known ten
/// must agree, and nothing is fused: a hand where nothing was seen before contradicts nothing.
class Confirmation {
 public:
  enum class Standing {
    Refused,
    Supposed,  ///< not to be told
    Agreeing,  ///< not to be fused
    Confirmed
  };

  /// Whether the frames before await more that agree with them.
  bool isAwaited() const { return agreed_ > 0; }
  /// Whether a frame of those that agree showed tracking.relocalised_share of what is known.
  bool knows() const { return knows_; }
  /// After a frame that was unsure, or while isAwaited(). `believed`: what believe() says of it. `lost`: that
  /// the frame before it had no pose.
  Standing next(const std::optional<Believed>& believed, double relocalised_share, bool unsure, bool lost);
  void end() { agreed_ = 0; }

 private:
  int agreed_ = 0;                                            ///< frames in turn, since one that was unsure
  bool firm_ = false, knows_ = false, knows_firmly_ = false;  ///< one of them
  bool was_lost_ = false;
};

}  // namespace rosefusion
