// From the figures of an inspection to plain words: every threshold and its reason.
#include <cmath>

#include "host/core/number_text.h"
#include "host/datasets/inspection.h"

namespace rosefusion {
namespace {

constexpr double kNearestMedian = 0.2,
                 kFurthestMedian = 20;  ///< metres; no depth camera's typical view lies outside
constexpr double kLowValidShare = 0.3;  ///< below, little is left to track by
constexpr double kHopelessValidShare = 0.05;
constexpr double kManyUnreadable = 0.5;
constexpr double kManyRepeated = 0.05, kFrozen = 0.9;  ///< shares of images identical to their predecessor
constexpr double kManyOddFrames = 0.02;
constexpr double kFastestKnown = 4;     ///< m/s; the paper's fastest sequence
constexpr double kTruthCoverage = 0.9;  ///< share of frames; recordings often start before the truth
constexpr double kSlowestRate = 1, kFastestRate = 1000;  ///< Hz; outside, stamps are hardly seconds

/// "1 gap", "2 gaps".
std::string counted(std::size_t count, const std::string& noun, std::string nouns = "") {
  if (nouns.empty()) nouns = noun + "s";
  return std::to_string(count) + " " + (count == 1 ? noun : nouns);
}

/// A scale in common use that would put the median depth into a room, as advice; empty when none does.
std::string likelyScale(double median_units) {
  const struct {
    double units;
    const char* where;
  } known[] = {{1000, "millimetres"},
               {5000, "TUM, ETH3D, ICL-NUIM"},
               {6553.5, "Replica"},
               {10000, "tenths of millimetres"}};
  for (const auto& scale : known)
    if (median_units / scale.units > 0.5 && median_units / scale.units < 8)
      return printed("; %g (%s) would make it %.2f m", scale.units, scale.where, median_units / scale.units);
  return "";
}

void judgeReading(const SequenceInfo& info, const Inspection& r, std::vector<Finding>& findings) {
  for (const std::string& warning : info.warnings) findings.push_back({false, warning, ""});
  const std::size_t bad = r.unreadable.size(), seen = bad + r.images_read;
  if (bad > 0) {
    const bool most = static_cast<double>(bad) > kManyUnreadable * static_cast<double>(seen);
    findings.push_back(
        {most,
         printed("%zu of %zu depth images cannot be read; frame %zu: ", bad, seen, r.unreadable[0].index) +
             r.unreadable[0].problem,
         most ? "copy or export the sequence again" : "they will be skipped; replace the files to use them"});
  }
  if (!r.colourless.empty())
    findings.push_back({false,
                        printed("%zu of %zu colour images cannot be used; frame %zu: ", r.colourless.size(),
                                r.images_read, r.colourless[0].index) +
                            r.colourless[0].problem,
                        "those frames are taken by their depth alone; export colour that is registered to "
                        "the depth images"});
  if (r.frames < 2 || (r.images_read < 2 && bad > 0))
    findings.push_back(
        {true, "only " + counted(r.images_read, "depth image") + " can be read",
         "a reconstruction needs at least two frames; check that the sequence was copied whole"});
}

void judgeDepth(const SequenceInfo& info, const Inspection& r, std::vector<Finding>& findings) {
  if (r.images_read == 0) return;
  const double images = static_cast<double>(r.images_read);
  if (!r.depth) {
    findings.push_back({true, "not one pixel has valid depth (all are 0 or 65535)",
                        "check that these are the depth images, and how they were exported"});
    return;
  }
  const double middle = r.depth->p50;
  if (middle < kNearestMedian || middle > kFurthestMedian)
    findings.push_back(
        {true,
         printed("half of all depths are %s %.3g m: the depth scale (%g units per metre) is hardly right",
                 middle < kNearestMedian ? "under" : "over", middle, info.depth_units_per_metre),
         "set depth_units_per_metre" + likelyScale(middle * info.depth_units_per_metre)});
  if (r.valid_share_median < kLowValidShare)
    findings.push_back(
        {r.valid_share_median < kHopelessValidShare,
         printed("half of the frames have valid depth in under %.1f %% of the pixels",
                 100 * r.valid_share_median),
         "stay within the camera's range, avoid glass and sunlight, or check the depth export"});
  else if (r.valid_share_worst < kHopelessValidShare && r.empty_frames == 0)
    findings.push_back(
        {false,
         printed("frame %zu has valid depth in only %.1f %% of its pixels", r.worst_frame,
                 100 * r.valid_share_worst),
         "expect tracking to be uncertain there; cut the sequence before it if it ends badly"});
  if (r.empty_frames > 0)
    findings.push_back({false, counted(r.empty_frames, "frame") + " without any valid depth",
                        "they cannot be tracked; remove them or check the camera"});
  if (static_cast<double>(r.flat_frames) > kManyOddFrames * images)
    findings.push_back({static_cast<double>(r.flat_frames) > kFrozen * images,
                        counted(r.flat_frames, "frame") + " with one and the same depth in every valid pixel",
                        "check that these are depth images and not masks"});
  if (static_cast<double>(r.repeated_images) > kManyRepeated * images)
    findings.push_back(
        {static_cast<double>(r.repeated_images) > kFrozen * images,
         counted(r.repeated_images, "exact copy", "exact copies") + " of the depth image before",
         "record or export at the camera's own rate; the camera may have frozen"});
}

void judgeTime(const SequenceInfo& info, const Inspection& r, std::vector<Finding>& findings) {
  if (r.frames > 1 && (r.frames_per_second < kSlowestRate || r.frames_per_second > kFastestRate))
    findings.push_back({false, printed("the time stamps make %.4g frames per second", r.frames_per_second),
                        "time stamps must be in seconds; correct the list or the fps"});
  if (r.repeated_stamps > 0)
    findings.push_back({false,
                        counted(r.repeated_stamps, "frame") + " with the same time stamp as the frame before",
                        "remove the doubled lines from the list"});
  if (!r.gaps.empty()) {
    const TimeGap* longest = &r.gaps[0];
    for (const TimeGap& gap : r.gaps)
      if (gap.seconds > longest->seconds) longest = &gap;
    findings.push_back(
        {false,
         counted(r.gaps.size(), "gap") +
             printed(" in time, the longest %.2f s after frame %zu", longest->seconds, longest->after_frame),
         "tracking may be lost there when the camera moves fast; look at the recorder's dropped frames"});
  }
  if (info.truth.empty()) return;
  const double covered = static_cast<double>(r.frames_with_truth) / static_cast<double>(r.frames);
  if (covered < kTruthCoverage)
    findings.push_back(
        {false,
         printed("the truth covers %zu of %zu frames: frames %.3f to %.3f, truth %.3f to %.3f",
                 r.frames_with_truth, r.frames, r.first_stamp, r.last_stamp, info.truth.front().timestamp,
                 info.truth.back().timestamp),
         covered > 0
             ? "frames without truth are left out of the evaluation"
             : "the truth's stamps do not match the frames'; check that both belong to one recording"});
  if (r.speeds && r.speeds->linear_max > kFastestKnown)
    findings.push_back(
        {false,
         printed("the camera moves at up to %.1f m/s, faster than the method was shown to track",
                 r.speeds->linear_max),
         "check that the truth is in metres and the stamps in seconds; else expect lost frames"});
}

}  // namespace

std::vector<Finding> findWhatLooksWrong(const SequenceInfo& info, const Inspection& inspection) {
  std::vector<Finding> findings;
  judgeReading(info, inspection, findings);
  if (info.intrinsics_assumed)
    findings.push_back(
        {false, "the intrinsics are assumed (" + info.intrinsics_source + "), not read from the data",
         std::string("give the camera's own: ") +
             (info.format.find("TUM") != std::string::npos ? "a calibration.txt with 'fx fy cx cy', " : "") +
             "a sequence.yaml, or --intrinsics"});
  judgeDepth(info, inspection, findings);
  judgeTime(info, inspection, findings);
  return findings;
}

}  // namespace rosefusion
