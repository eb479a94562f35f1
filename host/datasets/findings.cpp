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
constexpr double kManyOutside = 0.3,
                 kNearlyAllOutside = 0.95;  ///< of the valid pixels, outside depth.min..max
constexpr double kNearForARoom = 1;  ///< metres, of the 95th percentile; a camera in a room sees farther
constexpr double kNoise =
    0.25;  ///< mean difference of neighbours; surfaces with all their edges stay under a tenth
constexpr double kRough = 0.005, kPlainlyRougher = 4;  ///< no surface is smoother with its bytes exchanged
constexpr double kMostOffCentre = 0.15;                ///< of the image's size; lenses sit within a twentieth
constexpr double kMostOblong = 1.15;                   ///< ratio of the focal lengths
constexpr double kPartialStart = 0.6;                  ///< first image's valid pixels, of the median's
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
         most ? "copy or export the sequence again" : "they will be skipped; replace the files to use them",
         FindingKind::Unreadable});
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

/// Doubts about the depth scale that the median alone does not settle.
void judgeScale(const SequenceInfo& info, const Inspection& r, std::vector<Finding>& findings) {
  const double units = info.depth_units_per_metre;
  const std::string option = "give --depth-units-per-metre, or set it in a sequence.yaml";
  if (r.farther_share > kManyOutside)
    findings.push_back(
        {r.farther_share > kNearlyAllOutside,
         printed("%.0f %% of the valid depths lie beyond depth.max (%g m), where a run ignores them: the "
                 "depth scale (%g units per metre%s) is hardly right, or the scene is large",
                 100 * r.farther_share, r.limits.max, units, info.depth_units_assumed ? ", assumed" : ""),
         option + likelyScale(r.depth->p50 * units) + "; or run with --set depth.max=...",
         FindingKind::DepthScale});
  else if (r.nearer_share > kManyOutside)
    findings.push_back(
        {r.nearer_share > kNearlyAllOutside,
         printed("%.0f %% of the valid depths lie nearer than depth.min (%g m), where a run ignores "
                 "them: is the depth scale (%g units per metre%s) right?",
                 100 * r.nearer_share, r.limits.min, units, info.depth_units_assumed ? ", assumed" : ""),
         option + "; or run with --set depth.min=...", FindingKind::DepthScale});
  else if (info.depth_units_assumed && r.depth->p95 < kNearForARoom && units > 1000 && !r.truth_check.agrees)
    findings.push_back({false,
                        printed("the depth scale is assumed (%g units per metre, as %s has it), and 95 %% of "
                                "all depths lie under "
                                "%.2f m, which is near for a room",
                                units, info.format.c_str(), r.depth->p95),
                        "if the images are in millimetres, give --depth-units-per-metre 1000",
                        FindingKind::DepthScale});
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
         "set depth_units_per_metre (--depth-units-per-metre)" +
             likelyScale(middle * info.depth_units_per_metre),
         FindingKind::DepthScale});
  else
    judgeScale(info, r, findings);
  if (r.roughness > kRough && r.roughness > kPlainlyRougher * r.roughness_swapped)
    findings.push_back(
        {true,
         printed("the depth images are noise from pixel to pixel (neighbours differ by %.1f %%), and "
                 "surfaces (%.1f %%) with the bytes of each value exchanged",
                 100 * r.roughness, 100 * r.roughness_swapped),
         "the two bytes of each depth were written in the wrong order: a PNG has the high one first; "
         "export them again",
         FindingKind::ByteOrder});
  else if (r.roughness > kNoise)
    findings.push_back(
        {false,
         printed("the depth images are noise from pixel to pixel: neighbours differ by %.0f %%",
                 100 * r.roughness),
         "check that these are depth images, and how they were exported and resized",
         FindingKind::ByteOrder});
  if (r.valid_share_median < kLowValidShare)
    findings.push_back({r.valid_share_median < kHopelessValidShare,
                        printed("half of the frames have valid depth in under %.1f %% of the pixels",
                                100 * r.valid_share_median),
                        "stay within the camera's range, avoid glass and sunlight, or check the depth export",
                        FindingKind::Holes});
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

/// Of an image whose intrinsics have this principal point, if it lay in its middle.
std::string sizeThatFits(const Intrinsics& k) {
  return printed("%.0fx%.0f", 2 * k.cx + 1, 2 * k.cy + 1);
}

void judgeIntrinsics(const SequenceInfo& info, std::vector<Finding>& findings) {
  const Intrinsics& k = info.intrinsics;
  if (info.intrinsics_assumed)
    findings.push_back(
        {false, "the intrinsics are assumed (" + info.intrinsics_source + "), not read from the data",
         std::string("give the camera's own: ") +
             (info.format.find("TUM") != std::string::npos ? "a calibration.txt with 'fx fy cx cy', " : "") +
             "a sequence.yaml, or --intrinsics",
         FindingKind::Intrinsics});
  const double off_x = (k.cx + 0.5) / k.width - 0.5, off_y = (k.cy + 0.5) / k.height - 0.5;
  if (std::abs(off_x) > kMostOffCentre || std::abs(off_y) > kMostOffCentre)
    findings.push_back(
        {false,
         printed("the principal point (cx %g, cy %g) lies far from the middle of the %dx%d images, as if the "
                 "intrinsics (%s) were those of %s images",
                 k.cx, k.cy, k.width, k.height, info.intrinsics_source.c_str(), sizeThatFits(k).c_str()),
         printed("if so, scale them to the images' size: fx %.6g, fy %.6g, cx %.6g, cy %.6g",
                 k.fx * k.width / (2 * k.cx + 1), k.fy * k.height / (2 * k.cy + 1), (k.width - 1) / 2.0,
                 (k.height - 1) / 2.0),
         FindingKind::Intrinsics});
  if (const double ratio = std::abs(k.fy) / k.fx; ratio < 1 / kMostOblong || ratio > kMostOblong)
    findings.push_back(
        {false,
         printed("the focal lengths fx %g and fy %g differ, while depth cameras' pixels are square", k.fx,
                 k.fy),
         "check the order of the intrinsics (fx fy cx cy) and that they are for this image size",
         FindingKind::Intrinsics});
}

/// What stamps at this rate may be counted in; a camera has some 1 to 300 images a second.
std::string unitOfStamps(double rate) {
  const struct {
    double factor;
    const char* unit;
  } known[] = {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}};
  for (const auto& unit : known)
    if (rate > 0 && rate * unit.factor >= 1 && rate * unit.factor <= 300)
      return printed(" (these look like %s: divide them by %g)", unit.unit, unit.factor);
  return "";
}

void judgeTime(const SequenceInfo& info, const Inspection& r, std::vector<Finding>& findings) {
  const bool decimals_lost = 2 * r.repeated_stamps > r.frames;
  if (decimals_lost)
    findings.push_back(
        {false,
         printed("%zu of %zu frames have the time stamp of the frame before", r.repeated_stamps, r.frames),
         "the decimals were lost when the stamps were written, or the list holds several recordings; "
         "write them with six decimals",
         FindingKind::Time});
  else if (r.frames > 1 && (r.frames_per_second < kSlowestRate || r.frames_per_second > kFastestRate))
    findings.push_back({false, printed("the time stamps make %.4g frames per second", r.frames_per_second),
                        "time stamps must be in seconds" + unitOfStamps(r.frames_per_second) +
                            "; correct the list or the fps",
                        FindingKind::Time});
  if (r.repeated_stamps > 0 && !decimals_lost)
    findings.push_back({false,
                        counted(r.repeated_stamps, "frame") + " with the same time stamp as the frame before",
                        "remove the doubled lines from the list", FindingKind::Time});
  if (!r.gaps.empty()) {
    const TimeGap* longest = r.gaps.data();
    for (const TimeGap& gap : r.gaps)
      if (gap.seconds > longest->seconds) longest = &gap;
    findings.push_back(
        {false,
         counted(r.gaps.size(), "gap") +
             printed(" in time, the longest %.2f s after frame %zu", longest->seconds, longest->after_frame),
         "tracking may be lost there when the camera moves fast; look at the recorder's dropped frames"});
  }
  if (r.images_read > 1 && r.whole_from > 0 && r.valid_share_first < kPartialStart * r.valid_share_median)
    findings.push_back(
        {false,
         printed("the first image has valid depth in %.0f %% of its pixels, the median one in %.0f %%: the "
                 "camera was warming up, or covered",
                 100 * r.valid_share_first, 100 * r.valid_share_median),
         printed("the model begins with it; leave it out with 'run --start %zu'", r.whole_from),
         FindingKind::Start});
  if (info.truth.empty()) return;
  if (const auto& doubt = r.truth_check.doubt)
    findings.push_back(
        {false,
         printed("truth and depth images do not fit together: %.0f %% of the points seen twice lie in one "
                 "place, but "
                 "%.0f %% if ",
                 100 * doubt->agreement, 100 * doubt->other_agreement) +
             doubt->reading,
         doubt->remedy,
         doubt->reading.find("scale") != std::string::npos ? FindingKind::DepthScale : FindingKind::Other});
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
  judgeIntrinsics(info, findings);
  judgeDepth(info, inspection, findings);
  judgeTime(info, inspection, findings);
  return findings;
}

}  // namespace rosefusion
