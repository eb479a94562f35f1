#include "host/slam/relocalisation/pose_search.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr double kScanShift = 0.5, kScanTurn = 0.25;
// Searched by swarm, of the centres that are not followed; one where further poses are given, since a search
// costs as much as all of those together
// (tests/bench/notes/relocalisation.md#a-lost-camera-placed-by-planes).
constexpr std::size_t kScanKept = 3, kScanKeptBesides = 1;
constexpr int kFromAfar = 2;                         // times as far apart are the pixels looked at
constexpr double kSameShift = 0.1, kSameTurn = 0.1;  // of two descents to one pose
// How far beside the best places others are tried. A descent comes from about a truncation away.
constexpr double kAsides[] = {-0.4, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.4};
constexpr std::size_t kLookedBeside = 2;
constexpr int kRounds = 3;  // while they lead to a better one, which may still be on its way along a valley

void keepBest(std::vector<ScannedPose>& scanned, std::size_t most) {
  std::stable_sort(scanned.begin(), scanned.end(),
                   [](const ScannedPose& a, const ScannedPose& b) { return a.loss < b.loss; });
  scanned.resize(std::min(most, scanned.size()));
}

std::vector<Pose> posesOf(const std::vector<ScannedPose>& scanned) {
  std::vector<Pose> poses;
  for (const ScannedPose& pose : scanned) poses.push_back(pose.world_from_camera);
  return poses;
}

/// Sorted by cost, without those that lead to the same pose as a better one.
std::vector<PoseFit> distinct(std::vector<PoseFit> fits) {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; });
  std::vector<PoseFit> kept;
  for (const PoseFit& fit : fits)
    if (std::none_of(kept.begin(), kept.end(), [&](const PoseFit& other) {
          return areNear(fit.world_from_camera, other.world_from_camera, kSameShift, kSameTurn);
        }))
      kept.push_back(fit);
  return kept;
}

/// Makes the distinct fits the candidates, and the best of them the result.
void conclude(std::vector<PoseFit> fits, PoseRefiner& refiner, TrackResult& result) {
  result.candidates = distinct(std::move(fits));
  result.fit = result.candidates.front();
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner.takePointsRead();
}

}  // namespace

TrackResult searchAround(SwarmSearch& search, PoseRefiner& refiner, const RefineSettings& settings,
                         const DeviceFrame& frame, const Volume& volume, std::span<const Pose> centres,
                         std::size_t followed, const SearchObserver& observer, std::span<const Pose> more) {
  TrackResult result;
  std::vector<PoseFit> fits;
  std::vector<ScannedPose> scanned = search.scan(frame, volume, centres, kScanShift, kScanTurn);
  for (const ScannedPose& pose : scanned) result.lookups += pose.lookups;
  std::vector<ScannedPose> others(scanned.begin() + static_cast<std::ptrdiff_t>(followed), scanned.end());
  keepBest(others, more.empty() ? kScanKept : kScanKeptBesides);
  scanned.resize(followed);
  scanned.insert(scanned.end(), others.begin(), others.end());
  refiner.selectPixels(frame, settings.coarse_pixel_stride);
  for (const Pose& start : posesOf(scanned)) {
    const TrackResult found = search.search(frame, volume, start, start, observer);
    result.iterations += found.iterations;
    result.lookups += found.lookups;
    for (const PoseFit& fit : refiner.refine(volume, std::vector<Pose>{start, found.world_from_camera},
                                             settings.coarse_iterations, start))
      fits.push_back(fit);
  }
  for (const Pose& start : more)
    for (const PoseFit& fit :
         refiner.refine(volume, std::vector<Pose>{start}, settings.coarse_iterations, start))
      fits.push_back(fit);
  conclude(std::move(fits), refiner, result);
  return result;
}

void searchAlongNormals(PoseRefiner& refiner, const RefineSettings& settings, const Volume& volume,
                        TrackResult& found) {
  for (int round = 0; round < kRounds; ++round) {
    const Pose best = found.candidates.front().world_from_camera;
    std::vector<PoseFit> fits = found.candidates;
    for (std::size_t i = 0; i < std::min(kLookedBeside, found.candidates.size()); ++i) {
      const PoseFit& place = found.candidates[i];
      std::vector<Pose> beside;
      for (int axis = 0; axis < 3; ++axis)
        for (const double aside : kAsides) {
          beside.push_back(place.world_from_camera);
          beside.back().translation() += aside * place.normals.col(axis);
        }
      for (const PoseFit& fit :
           refiner.refine(volume, beside, settings.coarse_iterations, place.world_from_camera))
        fits.push_back(fit);
    }
    conclude(std::move(fits), refiner, found);
    if (areNear(best, found.candidates.front().world_from_camera, kSameShift, kSameTurn)) return;
  }
}

std::vector<Pose> alignCoarsely(PoseRefiner& refiner, const RefineSettings& settings,
                                const DeviceFrame& frame, const Volume& coarse, std::vector<Pose> places) {
  refiner.selectPixels(frame, kFromAfar * settings.coarse_pixel_stride);
  for (Pose& place : places)
    place = refiner.refine(coarse, std::vector<Pose>{place}, settings.coarse_iterations, place)[0]
                .world_from_camera;
  return places;
}

}  // namespace rosefusion
