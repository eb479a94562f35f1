#include "host/slam/tracking/tracker.h"

#include <cmath>

namespace rosefusion {
namespace {

// A frame's cost is suspicious beyond this factor of the recent ones' median, and this much more.
constexpr double kSuspiciousFactor = 1.3, kSuspiciousExcess = 0.05;

/// 0 for the expected pose, towards 1 beyond some centimetres or degrees.
double motionPriorCost(const Pose& pose, const Pose& expected) {
  constexpr double kShift = 0.05, kTurn = 0.1;
  const double shift = shiftBetween(pose, expected) / kShift;
  const double turn = turnInWorld(expected, pose).angle() / kTurn;
  return 1 - std::exp(-0.5 * (shift * shift + std::pow(turn, 2)));
}

}  // namespace

TrackResult Tracker::track(const DeviceFrame& frame, const Volume& volume, const TrackHistory& history,
                           double timestamp, const SearchObserver& observer) {
  TrackResult result;
  const Pose predicted = history.motion.predict(timestamp), expected = history.withOdometry(predicted);
  PoseFit best;
  double best_cost = 2;
  // Around a tentative pose the model does not grow, and most of the view may be unknown: a shift
  // that makes a little more of it known must not win over one that puts more onto the surfaces.
  const auto misfit = [&](const PoseFit& fit) {
    return (history.tentative ? 1 - fit.inlier_ratio : fit.cost) + fit.colour_cost;
  };
  const auto refineFrom = [&](const std::vector<Pose>& starts) {
    for (const PoseFit& fit : refiner_.refine(volume, starts, settings_.coarse_iterations, expected)) {
      const double cost =
          misfit(fit) + settings_.motion_preference * motionPriorCost(fit.world_from_camera, expected);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = fit;
    }
  };
  const auto searchFrom = [&](const Pose& start) {
    const TrackResult found = search_.search(frame, volume, start, history.last, observer);
    result.iterations += found.iterations;
    result.lookups += found.lookups;
    refineFrom({found.world_from_camera});
  };
  refiner_.selectPixels(frame, settings_.coarse_pixel_stride, history.last);
  refineFrom(history.odometry ? std::vector<Pose>{expected, history.last, predicted}
                              : std::vector<Pose>{expected, history.last});
  const std::optional<double> usual = history.medianCost();
  // Where the descent fits as well as it mostly does, the swarm looks in vain
  // (tests/bench/notes/tracking.md#the-swarm-where-it-is-needed).
  const bool is_usual = !history.tentative && history.remembersEnough() && best.cost <= *usual;
  if (!is_usual)
    searchFrom(best.world_from_camera);  // ends after max_empty_sets iterations where nothing better is near
  if (!usual || best.cost > kSuspiciousFactor * *usual + kSuspiciousExcess) {
    searchFrom(expected);
    searchFrom(history.last);
  }
  result.cost = best.cost;

  refiner_.selectPixels(frame, settings_.pixel_stride, history.last);
  result.fit =
      refiner_.refine(volume, std::vector<Pose>{best.world_from_camera}, settings_.iterations, expected)[0];
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner_.takePointsRead();
  return result;
}

}  // namespace rosefusion
