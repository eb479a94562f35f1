#include "host/run/likely_cause.h"

#include <algorithm>

#include "host/core/number_text.h"

namespace rosefusion {
namespace {

/// What makes tracking fail most surely comes first.
constexpr FindingKind kByWeight[] = {FindingKind::ByteOrder, FindingKind::DepthScale, FindingKind::Start,
                                     FindingKind::Holes,     FindingKind::Intrinsics, FindingKind::Time,
                                     FindingKind::Unreadable};

double medianValidShare(const RunSummary& summary) {
  std::vector<double> shares;
  for (const RunFrame& f : summary.frames)
    if (!f.skipped) shares.push_back(f.result.score.valid_share);
  if (shares.empty()) return 0;
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return *middle;
}

/// From the run alone.
std::string causeInFrames(const RunSummary& summary) {
  constexpr double kFewPixels = 0.3;
  const auto& frames = summary.frames;
  const auto is_lost = [](const RunFrame& f) {
    return !f.skipped && f.result.status == TrackingStatus::Lost;
  };
  const auto first =
      static_cast<std::size_t>(std::find_if(frames.begin(), frames.end(), is_lost) - frames.begin());
  const auto apart = std::count_if(frames.begin(), frames.end(),
                                   [&](const RunFrame& f) { return is_lost(f) && f.result.detached_map; });
  if (2 * static_cast<std::size_t>(apart) > summary.count(TrackingStatus::Lost))
    return printed(
        "from frame %zu on the camera saw nothing of what it had seen before; %zu of the frames hang "
        "together in "
        "maps of their own (map_2.txt); record a way that leads back, or begin there with --start N",
        frames[first].index, static_cast<std::size_t>(apart));
  const double valid = medianValidShare(summary), valid_first = frames.front().result.score.valid_share;
  if (valid < kFewPixels)
    return printed(
        "half of the frames have valid depth in under %.0f %% of the pixels: holes, or depths outside "
        "depth.min and depth.max; look at it with 'rosefusion check'",
        100 * valid + 1);
  if (first <= 2 && valid_first < 0.7 * valid)
    return printed(
        "the first frame is incomplete (%.0f %% valid, %.0f %% in the median), and the model begins with it; "
        "leave out the start with --start N",
        100 * valid_first, 100 * valid);
  if (first <= 2)
    return "tracking failed from the beginning: the depth scale (--depth-units-per-metre) or the intrinsics "
           "(--intrinsics) may be wrong, the first frames bad (--start N), or the frames too far apart; "
           "'rosefusion "
           "check' tells more";
  return printed(
      "from frame %zu on the camera moved too fast, came too near, or saw too little that holds a pose; take "
      "every frame (--stride 1), or record that part more slowly",
      frames[first].index);
}

}  // namespace

bool lostMost(const RunSummary& summary) {
  const std::size_t read = summary.frames.size() - summary.skipped();
  return 2 * summary.count(TrackingStatus::Lost) > read;
}

std::string likelyCause(const RunSummary& summary, const std::vector<Finding>& findings) {
  const std::string lost =
      printed("%zu of %zu frames were lost. The likely cause: ", summary.count(TrackingStatus::Lost),
              summary.frames.size() - summary.skipped());
  for (const FindingKind kind : kByWeight)
    for (const Finding& finding : findings)
      if (finding.kind == kind) return lost + finding.what + "; " + finding.remedy + ".";
  return lost + causeInFrames(summary) + ".";
}

}  // namespace rosefusion
