#include "host/locate.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr double kScanShift = 0.5, kScanTurn = 0.25;
constexpr std::size_t kScanKept = 3;

}  // namespace

TrackResult locate(SwarmSearch& search, Refiner& refiner, const RefineSettings& settings,
                   const PreprocessPass& frame, const Volume& volume, std::span<const Pose> centres,
                   const SearchObserver& observer) {
  TrackResult result;
  std::vector<ScannedPose> scanned = search.scan(frame, volume, centres, kScanShift, kScanTurn);
  for (const ScannedPose& pose : scanned) result.lookups += pose.lookups;
  const std::size_t kept = std::min(kScanKept, scanned.size());
  std::partial_sort(scanned.begin(), scanned.begin() + static_cast<std::ptrdiff_t>(kept), scanned.end(),
                    [](const ScannedPose& a, const ScannedPose& b) { return a.loss < b.loss; });
  refiner.look(frame, settings.coarse_pixel_stride);
  for (std::size_t i = 0; i < kept; ++i) {
    const Pose& start = scanned[i].world_from_camera;
    const SwarmResult found = search.search(frame, volume, start, start, observer);
    result.iterations += found.iterations;
    result.lookups += found.lookups;
    for (const PoseFit& fit : refiner.refine(volume, std::vector<Pose>{start, found.world_from_camera},
                                             settings.coarse_iterations, start))
      if (!result.fit || fit.cost < result.fit->cost) result.fit = fit;
  }
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner.takePointsRead();
  return result;
}

}  // namespace rosefusion
