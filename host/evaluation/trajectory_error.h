// How far an estimated trajectory is from the truth.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host/evaluation/alignment.h"
#include "host/evaluation/association.h"
#include "host/evaluation/error_summary.h"

namespace rosefusion {

struct TrajectoryErrorOptions {
  Association association = Association::Nearest;
  double max_difference_s = 0.02;  ///< evo's own default is 0.01
  double seconds_per_stamp = 1;    ///< see SequenceInfo; 1/30 where stamps are frame numbers
  /// Frames the sequence has, so that those without a pose count as lost. 0: worked out from the stamps, see
  /// TrajectoryErrors::frames_basis.
  std::size_t sequence_frames = 0;
  /// Stamps of estimated poses to leave out because the tracker itself called them lost.
  std::vector<double> lost_timestamps;
};

/// Errors of one common pose.
struct FrameError {
  PosePair poses;
  double ate_m = 0;  ///< distance of the positions after alignment
  double te_m = 0;   ///< TE, see TrajectoryErrors::te_m
};

/// With fewer the aligned errors say nothing: one or two poses can always be aligned.
inline constexpr std::size_t kFewestCommonPoses = 3;

inline constexpr std::array<double, 4> kTeThresholds_m{0.01, 0.02, 0.05, 0.10};

struct TrajectoryErrors {
  std::size_t estimate_poses = 0;  ///< without those lost or not finite
  std::size_t truth_poses = 0;
  std::size_t common_poses = 0;  ///< estimated poses that have a true one; all errors are over these
  std::size_t frames = 0;        ///< of the sequence
  std::size_t lost_frames = 0;   ///< frames without an estimated pose
  std::string frames_basis;      ///< how `frames` is known, for people
  std::string association;       ///< how poses were paired, for people
  Alignment alignment;

  /// Absolute trajectory error: distances of the camera positions after alignment. Its RMSE is what the TUM
  /// tools and evo (`evo_ape tum TRUTH ESTIMATE --align`) report, its mean is the paper's ATE.
  ErrorSummary ate_m;
  /// Translation error without alignment, |trans(inv(T_G) T_E)| [eq:te], both trajectories relative to their
  /// first common pose.
  ErrorSummary te_m;
  /// Share (0 to 1) of frames with TE under kTeThresholds_m. Lost frames count as failures; estimated poses
  /// without a true one are left out. NaN when nothing could be judged.
  std::array<double, kTeThresholds_m.size()> te_share{};
  /// Relative pose error from each common pose to the next.
  ErrorSummary rpe_frame_m, rpe_frame_deg;
  /// Relative pose error over one second: from each common pose to the one nearest a second later (at most
  /// 0.1 s off that), scaled to a second. In metres and degrees per second.
  ErrorSummary rpe_second_m, rpe_second_deg;

  std::vector<FrameError> per_frame;
  /// How many times as far the common true positions spread as the estimated ones; 0: not known.
  double spread_ratio = 0;
};

/// In words, what is wrong with the unit of one of the two where their sizes differ by more than a fifth;
/// else empty.
std::string scaleDoubt(const TrajectoryErrors& errors);

/// Unsorted trajectories are sorted; poses that are not finite count as lost (in the truth: as absent). No
/// common pose is no error: every summary is then empty (NaN) and common_poses is 0.
TrajectoryErrors measureTrajectory(const Trajectory& estimate, const Trajectory& truth,
                                   const TrajectoryErrorOptions& options = {});

}  // namespace rosefusion
