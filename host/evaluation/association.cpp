#include "host/evaluation/association.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

std::vector<PosePair> associateNearest(const Trajectory& estimate, const Trajectory& truth,
                                       double max_difference_s) {
  struct Candidate {
    double difference_s;
    std::size_t estimate, truth;
  };
  std::vector<Candidate> candidates;
  std::size_t window_begin = 0;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    const double t = estimate[e].timestamp;
    while (window_begin < truth.size() && truth[window_begin].timestamp < t - max_difference_s)
      ++window_begin;
    for (std::size_t g = window_begin; g < truth.size() && truth[g].timestamp - t <= max_difference_s; ++g)
      candidates.push_back({std::abs(truth[g].timestamp - t), e, g});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.difference_s < b.difference_s; });
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> partner(estimate.size(), kNone);
  std::vector<bool> taken(truth.size(), false);
  for (const Candidate& c : candidates) {
    if (partner[c.estimate] != kNone || taken[c.truth]) continue;
    partner[c.estimate] = c.truth;
    taken[c.truth] = true;
  }
  std::vector<PosePair> pairs;
  for (std::size_t e = 0; e < estimate.size(); ++e)
    if (partner[e] != kNone)
      pairs.push_back(
          {estimate[e].timestamp, estimate[e].world_from_camera, truth[partner[e]].world_from_camera});
  return pairs;
}

std::vector<PosePair> associateInterpolated(const Trajectory& estimate, const Trajectory& truth,
                                            double max_difference_s) {
  std::vector<PosePair> pairs;
  if (truth.empty()) return pairs;
  for (const StampedPose& e : estimate) {
    if (e.timestamp < truth.front().timestamp || e.timestamp > truth.back().timestamp) continue;
    PosePair pair{e.timestamp, e.world_from_camera};
    if (interpolate(truth, e.timestamp, 2 * max_difference_s, pair.truth)) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth, Association association,
                                double max_difference_s) {
  return association == Association::Nearest ? associateNearest(estimate, truth, max_difference_s)
                                             : associateInterpolated(estimate, truth, max_difference_s);
}

}  // namespace rosefusion
