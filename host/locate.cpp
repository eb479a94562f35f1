#include "host/locate.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr double kScanShift = 0.5, kScanTurn = 0.25;
constexpr std::size_t kScanKept = 3;
constexpr double kSameShift = 0.1, kSameTurn = 0.1;  // of two descents to one pose

// From afar: axis lengths of the swarms, in metres and of the quaternion's imaginary part, and how many go
// on.
struct Narrowing {
  double shift, turn;
};
constexpr Narrowing kWide{3, 0.04}, kInOverview[] = {{0.4, 0.06}, {0.15, 0.04}}, kInModel{0.07, 0.03};
constexpr std::size_t kPlacements = 192;  // of the widest swarm for one frame
constexpr std::size_t kWideKept = 24, kDescents = 6;

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

}  // namespace

TrackResult locate(SwarmSearch& search, Refiner& refiner, const RefineSettings& settings,
                   const PreprocessPass& frame, const Volume& volume, std::span<const Pose> centres,
                   std::size_t followed, const SearchObserver& observer, std::span<const Pose> more) {
  TrackResult result;
  std::vector<PoseFit> fits;
  std::vector<ScannedPose> scanned = search.scan(frame, volume, centres, kScanShift, kScanTurn);
  for (const ScannedPose& pose : scanned) result.lookups += pose.lookups;
  std::vector<ScannedPose> others(scanned.begin() + static_cast<std::ptrdiff_t>(followed), scanned.end());
  keepBest(others, kScanKept);
  scanned.resize(followed);
  scanned.insert(scanned.end(), others.begin(), others.end());
  refiner.look(frame, settings.coarse_pixel_stride);
  for (const Pose& start : posesOf(scanned)) {
    const SwarmResult found = search.search(frame, volume, start, start, observer);
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
  std::stable_sort(fits.begin(), fits.end(),
                   [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; });
  for (const PoseFit& fit : fits)
    if (std::none_of(result.candidates.begin(), result.candidates.end(), [&](const PoseFit& other) {
          return areNear(fit.world_from_camera, other.world_from_camera, kSameShift, kSameTurn);
        }))
      result.candidates.push_back(fit);
  result.fit = result.candidates.front();
  result.world_from_camera = result.fit->world_from_camera;
  result.lookups += kVoxelsPerPoint * refiner.takePointsRead();
  return result;
}

std::vector<Pose> locateWidely(SwarmSearch& search, const PreprocessPass& frame, const Volume& overview,
                               const Volume& volume, std::span<const Eigen::Vector3d> places,
                               std::span<const Eigen::Matrix3d> rotations, std::size_t turn,
                               std::uint64_t& lookups) {
  const std::size_t all = places.size() * rotations.size();
  std::vector<Pose> placements;
  for (std::size_t i = 0; i < std::min(all, kPlacements); ++i) {
    const std::size_t k = (turn * kPlacements + i) % all;
    Pose pose = Pose::Identity();
    pose.translation() = places[k / rotations.size()];
    pose.linear() = rotations[k % rotations.size()];
    placements.push_back(pose);
  }
  std::vector<ScannedPose> found;
  const auto scan = [&](const Volume& model, const Narrowing& n, std::size_t keep) {
    found = search.scan(frame, model, placements, n.shift, n.turn, turn);
    for (const ScannedPose& pose : found) lookups += pose.lookups;
    keepBest(found, keep);
    placements = posesOf(found);
  };
  scan(overview, kWide, kWideKept);
  for (const Narrowing& n : kInOverview) scan(overview, n, kWideKept);
  scan(volume, kInModel, kDescents);
  return placements;
}

}  // namespace rosefusion
