#include "host/synth/walk.h"

#include <cmath>

#include "host/core/error.h"
#include "host/synth/motion.h"

namespace rosefusion {
namespace {

constexpr int kCandidates = 40;    // tried for each key
constexpr double kMinStep = 0.45;  // metres between keys
constexpr double kMaxStep = 0.9;
constexpr double kMaxTurnCosine =
    0.17;  // 80 degrees: sharper turns would be cusps when walked at an even speed

/// A random direction, more level than steep.
Eigen::Vector3d levelled(const Eigen::Vector3d& direction, double share, const Eigen::Vector3d& up) {
  return (direction - share * direction.dot(up) * up).normalized();
}

}  // namespace

Walk::Cell Walk::cellOf(const Eigen::Vector3d& point) {
  const Eigen::Vector3i c = (point / 0.6).array().floor().cast<int>();
  return {c.x(), c.y(), c.z()};
}

bool Walk::start() {
  spline_ = {};
  visits_.clear();
  for (int attempt = 0; attempt < 200; ++attempt) {
    const Eigen::Vector3d p = space_.randomCell(rng_),
                          d = 0.15 * levelled(rng_.direction(), 0.7, space_.up());
    if (!space_.contains(p + 2 * d) || !space_.isSegmentClear(p, p + 2 * d, kPathClearance)) continue;
    for (int i = 0; i < 3; ++i) spline_.push(p + i * d);
    return true;
  }
  return false;
}

bool Walk::extend(const std::function<double(const Eigen::Vector3d&)>& attraction) {
  const auto& keys = spline_.keys();
  const Eigen::Vector3d last = keys.back(), heading = (last - keys[keys.size() - 2]).normalized();
  Eigen::Vector3d best;
  double best_score = -1e9;
  for (int i = 0; i < kCandidates; ++i) {
    const Eigen::Vector3d d = levelled(rng_.direction(), 0.6, space_.up());
    if (d.dot(heading) < kMaxTurnCosine) continue;
    const Eigen::Vector3d p = last + d * rng_.uniform(kMinStep, kMaxStep);
    if (!space_.contains(p) || !space_.isSegmentClear(last, p, kPathClearance)) continue;
    // Room ahead, so that the next key is easy to find, and places not yet visited.
    double ahead = 0;
    while (ahead < 1.2 && space_.contains(p + d * (ahead + 0.2))) ahead += 0.2;
    const auto visits = visits_.find(cellOf(p));
    const double score = rng_.uniform() + 0.6 * ahead +
                         1.2 / (1 + (visits == visits_.end() ? 0 : visits->second)) +
                         (attraction ? attraction(p) : 0);
    if (score <= best_score || !isPieceClear(p)) continue;
    best = p;
    best_score = score;
  }
  if (best_score < -1e8) return false;
  spline_.push(best);
  ++visits_[cellOf(best)];
  return true;
}

void Walk::backtrack(int count) {
  while (count-- > 0 && spline_.keys().size() > 3) spline_.pop();
}

bool Walk::isPieceClear(const Eigen::Vector3d& next) const {
  const auto& keys = spline_.keys();
  const Eigen::Vector3d four[] = {keys[keys.size() - 3], keys[keys.size() - 2], keys.back(), next};
  for (int i = 1; i <= 12; ++i)
    if (!space_.isClear(blend(four, i / 12.0), kPathClearance)) return false;
  return true;
}

PositionSpline wander(const FreeSpace& space, double length, Rng& rng) {
  for (int attempt = 0; attempt < 30; ++attempt) {
    Walk walk(space, rng);
    if (!walk.start()) continue;
    for (int backtracks = 0; backtracks < 200 && walk.spline().length() < length;)
      if (!walk.extend()) {
        walk.backtrack(4);
        ++backtracks;
      }
    if (walk.spline().length() >= length) return walk.take();
  }
  throw InputError(
      "The scene leaves too little free space to fly through; try another seed, a larger mesh, or --motion "
      "rotation.");
}

}  // namespace rosefusion
