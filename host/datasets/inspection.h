// Looks through a whole sequence before it is reconstructed: figures, and in plain words what looks wrong.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/datasets/sequence.h"
#include "host/datasets/truth_agreement.h"

namespace rosefusion {

struct TimeGap {
  std::size_t after_frame = 0;
  double seconds = 0;
};

struct UnreadableFrame {
  std::size_t index = 0;
  std::string problem;  ///< one sentence that names the file
};

/// Depths below which 1, 5, 50, 95 and 99 % of all valid pixels lie, metres.
struct DepthPercentiles {
  double p1 = 0, p5 = 0, p50 = 0, p95 = 0, p99 = 0;
};

/// Between consecutive frames, from the truth: metres and radians per second.
struct CameraSpeeds {
  double linear_mean = 0, linear_max = 0, angular_mean = 0, angular_max = 0;
};

/// What a finding is about, so that a run that failed can name its likely cause.
enum class FindingKind { Other, Unreadable, Intrinsics, DepthScale, ByteOrder, Holes, Start, Time };

/// Something that looks wrong. `fatal`: reconstruction cannot succeed before it is changed.
struct Finding {
  bool fatal = false;
  std::string what;
  std::string remedy;
  FindingKind kind = FindingKind::Other;
};

/// Depths that a reconstruction uses (depth.min and depth.max of the settings), metres.
struct DepthLimits {
  double min = 0.1, max = 8;
};

struct Inspection {
  std::size_t frames = 0;
  std::size_t images_read = 0;  ///< images looked at and readable; fewer than frames with a limit
  std::vector<UnreadableFrame> unreadable;
  std::vector<UnreadableFrame> colourless;  ///< with a colour image that cannot be used; their depth can
  double first_stamp = 0, last_stamp = 0;   ///< in the data set's own unit
  double seconds = 0;                       ///< from the first to the last stamp
  double frames_per_second = 0;             ///< 1 / median interval; 0 when unknown
  std::vector<TimeGap> gaps;                ///< intervals over kGapFactor times the median
  std::size_t repeated_stamps = 0;
  double valid_share_median = 0;  ///< of the pixels, over the frames
  double valid_share_worst = 1;
  std::size_t worst_frame = 0;
  std::size_t empty_frames = 0;           ///< frames with no valid pixel
  std::size_t repeated_images = 0;        ///< depth images identical to the one looked at before
  std::size_t flat_frames = 0;            ///< frames whose valid pixels all have one value
  std::optional<DepthPercentiles> depth;  ///< nothing when no pixel is valid
  DepthLimits limits;
  double nearer_share = 0, farther_share = 0;  ///< of the valid pixels, outside the limits
  double valid_share_first = 0;                ///< of the first image
  std::size_t whole_from = 0;  ///< the first frame with nearly as many valid pixels as the median one
  /// By how much neighbouring valid pixels differ, of the larger one: mean, median over the frames; and the
  /// same with the two bytes of each value exchanged.
  double roughness = 0, roughness_swapped = 0;
  TruthCheck truth_check;
  std::size_t frames_with_truth = 0;
  std::optional<CameraSpeeds> speeds;
  std::vector<Finding> findings;
  bool usable() const;
};

/// An interval this many times the median one is a gap: at least two frames are missing.
inline constexpr double kGapFactor = 2.5;

/// Reads at most `max_images` depth images, spread evenly over the sequence (0: all); stamps and truth are
/// always looked at whole. `progress`(done, total) is called after each image. Never throws for bad frames.
Inspection inspectSequence(Sequence& sequence, std::size_t max_images = 0,
                           const std::function<void(std::size_t, std::size_t)>& progress = {},
                           const DepthLimits& limits = {});

/// The judgement over the figures, called by inspectSequence(): the thresholds lie here, and only here.
std::vector<Finding> findWhatLooksWrong(const SequenceInfo& info, const Inspection& inspection);

}  // namespace rosefusion
