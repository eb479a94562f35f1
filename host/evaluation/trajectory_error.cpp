#include "host/evaluation/trajectory_error.h"
#include "host/core/number_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <sstream>

namespace rosefusion {
namespace {

// How far from one second the end of a relative motion may lie; enough for 5 Hz.
constexpr double kSecondTolerance_s = 0.1;

std::vector<double> stamps(const Trajectory& trajectory) {
  std::vector<double> result;
  for (const StampedPose& p : trajectory) result.push_back(p.timestamp);
  return result;
}

bool hasNear(const std::vector<double>& sorted, double t, double tolerance) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), t - tolerance);
  return at != sorted.end() && *at <= t + tolerance;
}

/// The sorted, finite part of a trajectory without the poses at the stamps in `lost` (sorted).
Trajectory usablePart(Trajectory trajectory, const std::vector<double>& lost) {
  constexpr double kSameStamp_s = 1e-6;  // stamps are stored in microseconds
  std::erase_if(trajectory, [&](const StampedPose& p) {
    return !std::isfinite(p.timestamp) || !p.world_from_camera.matrix().allFinite() ||
           hasNear(lost, p.timestamp, kSameStamp_s);
  });
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
  return trajectory;
}

double quantile(std::vector<double> values, std::size_t numerator, std::size_t denominator) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * numerator / denominator);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Median of the intervals without lost frames between; 0 for fewer than two stamps. Those are told by the
/// lower quartile, which a tracker that dropped many frames does not move.
double usualInterval(const std::vector<double>& sorted_stamps) {
  if (sorted_stamps.size() < 2) return 0;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted_stamps.size(); ++i)
    gaps.push_back(sorted_stamps[i] - sorted_stamps[i - 1]);
  const double longest = 1.5 * quantile(gaps, 1, 4);
  std::erase_if(gaps, [&](double gap) { return gap > longest; });
  return quantile(gaps, 1, 2);
}

std::size_t missingInGaps(const std::vector<double>& sorted_stamps, double interval) {
  std::size_t missing = 0;
  for (std::size_t i = 1; interval > 0 && i < sorted_stamps.size(); ++i) {
    const double steps = std::round((sorted_stamps[i] - sorted_stamps[i - 1]) / interval);
    if (steps > 1) missing += static_cast<std::size_t>(steps) - 1;
  }
  return missing;
}

void countFrames(const Trajectory& estimate, const Trajectory& truth, const std::vector<double>& lost,
                 const TrajectoryErrorOptions& options, TrajectoryErrors& errors) {
  std::vector<double> estimated = stamps(estimate);
  const double estimate_interval = usualInterval(estimated), truth_interval = usualInterval(stamps(truth));
  TextStream basis;
  if (options.sequence_frames > 0) {
    errors.frames = std::max(options.sequence_frames, estimate.size());
    errors.lost_frames = errors.frames - estimate.size();
    basis << "the sequence's number of frames was given";
  } else if (truth_interval >= 0.75 * estimate_interval) {
    // Half an interval at most, or a neighbouring frame's estimate would stand in for a lost one.
    const double max_difference = options.max_difference_s / options.seconds_per_stamp;
    const double tolerance =
        truth_interval > 0 ? std::min(max_difference, truth_interval / 2) : max_difference;
    errors.lost_frames =
        static_cast<std::size_t>(std::count_if(truth.begin(), truth.end(), [&](const auto& p) {
          return !hasNear(estimated, p.timestamp, tolerance);
        }));
    basis << "every true pose is taken as a frame of the sequence";
  } else {
    // The truth is denser than the frames (motion capture): only gaps tell of lost frames, not a lost end.
    std::vector<double> seen;
    std::merge(estimated.begin(), estimated.end(), lost.begin(), lost.end(), std::back_inserter(seen));
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    errors.lost_frames = seen.size() - estimate.size() + missingInGaps(seen, estimate_interval);
    basis << "gaps in the estimate, whose usual interval is " << estimate_interval * options.seconds_per_stamp
          << " s; frames lost before or after it are not known";
  }
  errors.frames = estimate.size() + errors.lost_frames;
  errors.frames_basis = basis.str();
}

std::string describeAssociation(const TrajectoryErrors& errors, const TrajectoryErrorOptions& options) {
  TextStream text;
  if (options.association == Association::Nearest)
    text << "nearest stamps, one to one, at most " << options.max_difference_s << " s apart";
  else
    text << "truth interpolated at the estimate's stamps, across at most " << 2 * options.max_difference_s
         << " s";
  text << ": " << errors.common_poses << " of " << errors.estimate_poses
       << " estimated poses have a true one";
  return text.str();
}

struct RelativeError {
  double translation_m;
  double rotation_deg;
};

RelativeError relativeError(const PosePair& from, const PosePair& to) {
  const Pose error = (from.truth.inverse() * to.truth).inverse() * (from.estimate.inverse() * to.estimate);
  return {error.translation().norm(), rotationAngle(error) * 180 / std::numbers::pi};
}

void measureRelative(TrajectoryErrors& errors, double seconds_per_stamp) {
  std::vector<double> frame_m, frame_deg, second_m, second_deg;
  const std::vector<FrameError>& frames = errors.per_frame;
  std::size_t to = 0;
  for (std::size_t from = 0; from + 1 < frames.size(); ++from) {
    const RelativeError step = relativeError(frames[from].poses, frames[from + 1].poses);
    frame_m.push_back(step.translation_m);
    frame_deg.push_back(step.rotation_deg);

    const double later = frames[from].poses.timestamp + 1 / seconds_per_stamp;
    const auto offBy = [&](std::size_t i) { return std::abs(frames[i].poses.timestamp - later); };
    while (to + 1 < frames.size() && offBy(to + 1) <= offBy(to)) ++to;
    if (offBy(to) * seconds_per_stamp > kSecondTolerance_s) continue;
    const double duration_s = (frames[to].poses.timestamp - frames[from].poses.timestamp) * seconds_per_stamp;
    const RelativeError second = relativeError(frames[from].poses, frames[to].poses);
    second_m.push_back(second.translation_m / duration_s);
    second_deg.push_back(second.rotation_deg / duration_s);
  }
  errors.rpe_frame_m = summarise(frame_m);
  errors.rpe_frame_deg = summarise(frame_deg);
  errors.rpe_second_m = summarise(second_m);
  errors.rpe_second_deg = summarise(second_deg);
}

double spreadRatio(const std::vector<PosePair>& pairs) {
  if (pairs.size() < kFewestCommonPoses) return 0;
  Eigen::Vector3d estimated = Eigen::Vector3d::Zero(), truth = estimated;
  for (const PosePair& p : pairs) estimated += p.estimate.translation(), truth += p.truth.translation();
  estimated /= static_cast<double>(pairs.size()), truth /= static_cast<double>(pairs.size());
  double of_estimate = 0, of_truth = 0;
  for (const PosePair& p : pairs) {
    of_estimate += (p.estimate.translation() - estimated).squaredNorm();
    of_truth += (p.truth.translation() - truth).squaredNorm();
  }
  return of_estimate > 0 ? std::sqrt(of_truth / of_estimate) : 0;
}

}  // namespace

std::string scaleDoubt(const TrajectoryErrors& errors) {
  constexpr double kUsual = 1.25;
  const double ratio = errors.spread_ratio;
  if (ratio <= 0 || (ratio < kUsual && ratio > 1 / kUsual)) return "";
  const auto is_near = [&](double factor) {
    return std::abs(ratio / factor - 1) < 0.15 || std::abs(ratio * factor - 1) < 0.15;
  };
  return printed("The true positions spread %.4g times as far as the estimated ones: ", ratio) +
         (is_near(1000) ? "one of the two is in millimetres; bring both to metres."
          : is_near(100)
              ? "one of the two is in centimetres; bring both to metres."
              : "check that both are in metres, and the depth scale (depth units per metre) that the "
                "estimate was made with.");
}

TrajectoryErrors measureTrajectory(const Trajectory& estimate_in, const Trajectory& truth_in,
                                   const TrajectoryErrorOptions& options) {
  std::vector<double> lost = options.lost_timestamps;
  for (const StampedPose& p : estimate_in)
    if (std::isfinite(p.timestamp) && !p.world_from_camera.matrix().allFinite()) lost.push_back(p.timestamp);
  std::erase_if(lost, [](double t) { return !std::isfinite(t); });
  std::sort(lost.begin(), lost.end());
  const Trajectory estimate = usablePart(estimate_in, lost), truth = usablePart(truth_in, {});

  const std::vector<PosePair> pairs =
      associate(estimate, truth, options.association, options.max_difference_s / options.seconds_per_stamp);
  TrajectoryErrors errors;
  errors.estimate_poses = estimate.size();
  errors.truth_poses = truth.size();
  errors.common_poses = pairs.size();
  errors.association = describeAssociation(errors, options);
  countFrames(estimate, truth, lost, options, errors);
  errors.alignment = alignPoses(pairs);

  std::vector<double> ate, te;
  for (const PosePair& p : pairs) {
    const Pose estimate_in_first = pairs.front().estimate.inverse() * p.estimate;
    const Pose truth_in_first = pairs.front().truth.inverse() * p.truth;
    te.push_back((truth_in_first.inverse() * estimate_in_first).translation().norm());
    const Eigen::Vector3d aligned = errors.alignment.truth_from_estimate * p.estimate.translation();
    ate.push_back((aligned - p.truth.translation()).norm());
    errors.per_frame.push_back({p, ate.back(), te.back()});
  }
  errors.spread_ratio = spreadRatio(pairs);
  const double judged = static_cast<double>(pairs.size() + errors.lost_frames);
  for (std::size_t i = 0; i < kTeThresholds_m.size(); ++i) {
    const auto under = std::count_if(te.begin(), te.end(), [&](double e) { return e < kTeThresholds_m[i]; });
    errors.te_share[i] =
        judged > 0 ? static_cast<double>(under) / judged : std::numeric_limits<double>::quiet_NaN();
  }
  errors.ate_m = summarise(ate);
  errors.te_m = summarise(te);
  measureRelative(errors, options.seconds_per_stamp);
  return errors;
}

}  // namespace rosefusion
