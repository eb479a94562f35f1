#include "host/datasets/inspection.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rosefusion {
namespace {

constexpr double kTruthMaxGap =
    0.1;  ///< seconds; truth further apart than this says nothing about a frame between

/// How often each of the 65536 depth values occurs.
using Histogram = std::vector<std::uint64_t>;

bool isValid(std::size_t value) {
  return value != 0 && value != 65535;
}

Histogram histogramOf(const cv::Mat& depth) {
  Histogram histogram(65536, 0);
  for (int v = 0; v < depth.rows; ++v)
    for (const auto *pixel = depth.ptr<std::uint16_t>(v), *end = pixel + depth.cols; pixel != end; ++pixel)
      ++histogram[*pixel];
  return histogram;
}

std::uint64_t validCount(const Histogram& histogram) {
  std::uint64_t count = 0;
  for (std::size_t value = 0; value < histogram.size(); ++value)
    if (isValid(value)) count += histogram[value];
  return count;
}

/// Of the valid pixels, those above (or below) `value`.
double shareBeyond(const Histogram& histogram, double value, bool above) {
  std::uint64_t count = 0;
  for (std::size_t v = 0; v < histogram.size(); ++v)
    if (isValid(v) && (above ? static_cast<double>(v) > value : static_cast<double>(v) < value))
      count += histogram[v];
  return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, validCount(histogram)));
}

/// By how much neighbours in every fourth row that are both valid differ, in the mean and of the larger one;
/// 0 without any.
double roughness(const cv::Mat& depth, bool swapped) {
  std::size_t pairs = 0;
  double sum = 0;
  const auto value = [&](std::uint16_t v) { return swapped ? (v << 8 & 0xFF00) | v >> 8 : int(v); };
  for (int v = 0; v < depth.rows; v += 4) {
    const auto* row = depth.ptr<std::uint16_t>(v);
    for (int u = 1; u < depth.cols; ++u) {
      if (!isValid(row[u - 1]) || !isValid(row[u])) continue;
      const int a = value(row[u - 1]), b = value(row[u]);
      ++pairs;
      sum += static_cast<double>(std::abs(a - b)) / std::max(a, b);
    }
  }
  return pairs == 0 ? 0 : sum / static_cast<double>(pairs);
}

/// The smallest valid value with at least `share` of the valid pixels at or below it.
double percentile(const Histogram& histogram, double share) {
  const double wanted = share * static_cast<double>(validCount(histogram));
  double count = 0;
  std::size_t last = 0;
  for (std::size_t value = 0; value < histogram.size(); ++value) {
    if (!isValid(value) || histogram[value] == 0) continue;
    count += static_cast<double>(histogram[value]);
    last = value;
    if (count >= wanted) break;
  }
  return static_cast<double>(last);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void inspectTimes(const Sequence& sequence, Inspection& result) {
  const double unit = sequence.info().seconds_per_stamp;
  result.first_stamp = sequence.timestamp(0);
  result.last_stamp = sequence.timestamp(sequence.size() - 1);
  std::vector<double> intervals;
  for (std::size_t i = 1; i < sequence.size(); ++i)
    intervals.push_back((sequence.timestamp(i) - sequence.timestamp(i - 1)) * unit);
  if (intervals.empty()) return;
  const double typical = median(intervals);
  result.seconds = (result.last_stamp - result.first_stamp) * unit;
  if (typical > 0) result.frames_per_second = 1 / typical;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (typical > 0 && intervals[i] > kGapFactor * typical) result.gaps.push_back({i, intervals[i]});
    if (intervals[i] <= 0) ++result.repeated_stamps;
  }
}

void inspectTruth(const Sequence& sequence, Inspection& result) {
  const SequenceInfo& info = sequence.info();
  CameraSpeeds speeds;
  double linear_sum = 0, angular_sum = 0;
  std::size_t steps = 0;
  bool before_known = false;
  Pose before;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    Pose pose = Pose::Identity();
    const bool known =
        interpolate(info.truth, sequence.timestamp(i), kTruthMaxGap / info.seconds_per_stamp, pose);
    result.frames_with_truth += known ? 1 : 0;
    const double seconds =
        i == 0 ? 0 : (sequence.timestamp(i) - sequence.timestamp(i - 1)) * info.seconds_per_stamp;
    if (known && before_known && seconds > 0) {
      const double linear = (pose.translation() - before.translation()).norm() / seconds;
      const double angular = rotationAngle(before.inverse() * pose) / seconds;
      linear_sum += linear;
      angular_sum += angular;
      speeds.linear_max = std::max(speeds.linear_max, linear);
      speeds.angular_max = std::max(speeds.angular_max, angular);
      ++steps;
    }
    before = pose;
    before_known = known;
  }
  if (steps == 0) return;
  speeds.linear_mean = linear_sum / static_cast<double>(steps);
  speeds.angular_mean = angular_sum / static_cast<double>(steps);
  result.speeds = speeds;
}

void inspectImages(Sequence& sequence, std::size_t max_images,
                   const std::function<void(std::size_t, std::size_t)>& progress, Inspection& result) {
  const std::size_t total = max_images == 0 ? sequence.size() : std::min(max_images, sequence.size());
  Histogram all(65536, 0);
  std::vector<double> shares, rough, rough_swapped;
  std::vector<std::size_t> looked_at;
  cv::Mat before;
  for (std::size_t n = 0; n < total; ++n) {
    const std::size_t index = n * sequence.size() / total;
    Frame frame;
    std::string problem;
    if (!sequence.read(index, frame, problem)) {
      result.unreadable.push_back({index, problem});
      if (progress) progress(n + 1, total);
      continue;
    }
    if (!problem.empty()) result.colourless.push_back({index, problem});
    const Histogram histogram = histogramOf(frame.depth);
    const std::uint64_t valid = validCount(histogram);
    std::size_t distinct = 0;
    for (std::size_t value = 0; value < all.size(); ++value) {
      all[value] += histogram[value];
      if (isValid(value) && histogram[value] > 0) ++distinct;
    }
    const double share = static_cast<double>(valid) / static_cast<double>(frame.depth.total());
    shares.push_back(share);
    looked_at.push_back(index);
    rough.push_back(roughness(frame.depth, false));
    rough_swapped.push_back(roughness(frame.depth, true));
    if (share < result.valid_share_worst || shares.size() == 1) {
      result.valid_share_worst = share;
      result.worst_frame = index;
    }
    if (valid == 0) ++result.empty_frames;
    if (valid > 0 && distinct == 1) ++result.flat_frames;
    if (!before.empty() && cv::norm(before, frame.depth, cv::NORM_INF) == 0) ++result.repeated_images;
    before = frame.depth;
    if (progress) progress(n + 1, total);
  }
  result.images_read = shares.size();
  result.valid_share_median = median(shares);
  result.roughness = median(rough);
  result.roughness_swapped = median(rough_swapped);
  constexpr double kNearlyAll = 0.8;
  if (!shares.empty()) result.valid_share_first = shares[0];
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] >= kNearlyAll * result.valid_share_median) {
      result.whole_from = looked_at[i];
      break;
    }
  const double units = sequence.info().depth_units_per_metre;
  result.nearer_share = shareBeyond(all, result.limits.min * units, false);
  result.farther_share = shareBeyond(all, result.limits.max * units, true);
  if (validCount(all) == 0) return;
  const auto metres = [&](double share) {
    return percentile(all, share) / sequence.info().depth_units_per_metre;
  };
  result.depth = DepthPercentiles{metres(0.01), metres(0.05), metres(0.5), metres(0.95), metres(0.99)};
}

}  // namespace

bool Inspection::usable() const {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& finding) { return finding.fatal; });
}

Inspection inspectSequence(Sequence& sequence, std::size_t max_images,
                           const std::function<void(std::size_t, std::size_t)>& progress,
                           const DepthLimits& limits) {
  Inspection result;
  result.limits = limits;
  result.frames = sequence.size();
  inspectTimes(sequence, result);
  inspectTruth(sequence, result);
  inspectImages(sequence, max_images, progress, result);
  result.truth_check = checkTruth(sequence);
  result.findings = findWhatLooksWrong(sequence.info(), result);
  return result;
}

}  // namespace rosefusion
