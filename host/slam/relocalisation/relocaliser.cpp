#include "host/slam/relocalisation/relocaliser.h"

#include <algorithm>
#include <numeric>

#include "host/slam/relocalisation/pose_search.h"

namespace rosefusion {
namespace {

constexpr std::size_t kSearchedAtOnce =
    32;  // keyframes' surroundings; of more, each frame takes the next ones

// Of plane alignment: rotations come from the commonest directions, by the least share of normals of each.
constexpr std::size_t kDirectionsOfView = 5, kDirectionsOfModel = 20, kRotations = 48;
constexpr double kShareOfView = 0.04, kShareOfModel = 0.008;
constexpr std::size_t kAligned = 1000, kAlignedKept = 48;  // poses, before and after a quick score
constexpr double kAgainstCounts = 4;  // what speaks against a place, to the patches that meet the model

std::vector<PoseHypothesis> planeHypotheses(const Keyframes& keyframes, const cv::Mat& metres) {
  const std::vector<SurfacePatch> view = keyframes.patchesOf(metres), known = keyframes.patches();
  const auto rotations =
      rotationHypotheses(dominantDirections(normalsOf(view), kShareOfView, kDirectionsOfView),
                         dominantDirections(normalsOf(known), kShareOfModel, kDirectionsOfModel), kRotations);
  return poseHypotheses(view, known, rotations, kAligned);
}

/// Where the surfaces in the image lie on known ones and not where there was nothing, the likeliest first.
std::vector<Pose> likelyHypotheses(const Map& map, const cv::Mat& metres) {
  const std::vector<PoseHypothesis> places = planeHypotheses(map.keyframes, metres);
  std::vector<Pose> poses;
  for (const PoseHypothesis& place : places) poses.push_back(place.world_from_camera);
  const std::vector<double> against = map.free_space.quickScore(metres, poses);
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto likeliness = [&](std::size_t i) { return places[i].met - kAgainstCounts * against[i]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return likeliness(a) > likeliness(b); });
  std::vector<Pose> likely;
  for (const std::size_t i : order)
    if (likely.size() < kAlignedKept) likely.push_back(poses[i]);
  return likely;
}

}  // namespace

TrackResult Relocaliser::find(const DeviceFrame& frame, const cv::Mat& metres, const Map& map,
                              const TrackHistory& before, double timestamp, const SearchObserver& observer) {
  const std::vector<Keyframe>& keyframes = map.keyframes.all();
  // Where it is expected is followed, whatever the keyframes' surroundings promise.
  auto [centres, followed] = before.expectedPoses(timestamp);
  for (std::size_t i = 0; i < std::min(kSearchedAtOnce, keyframes.size()); ++i)
    centres.push_back(keyframes[searched_++ % keyframes.size()].world_from_camera);
  const std::vector<Pose> more =
      alignCoarsely(refiner_, settings_, frame, map.coarse.volume(), likelyHypotheses(map, metres));
  TrackResult found =
      searchAround(search_, refiner_, settings_, frame, map.volume, centres, followed, observer, more);
  searchAlongNormals(refiner_, settings_, map.volume, found);
  return found;
}

}  // namespace rosefusion
