#include "host/slam/relocalisation/relocaliser.h"

#include <algorithm>
#include <numeric>

#include "host/slam/relocalisation/pose_search.h"

namespace rosefusion {
namespace {

// A keyframe is added where none is within this; the surroundings of each are searched when lost.
constexpr double kKeyframeShift = 0.4, kKeyframeTurn = 0.4;
constexpr std::size_t kSearchedAtOnce = 32;  // keyframes; of more, each frame takes the next ones

// Of plane alignment: rotations come from the commonest directions, by the least share of normals of each.
constexpr std::size_t kDirectionsOfView = 5, kDirectionsOfModel = 20, kRotations = 48;
constexpr double kShareOfView = 0.04, kShareOfModel = 0.008;
constexpr std::size_t kAligned = 1000, kAlignedKept = 48;  // poses, before and after a quick score
constexpr double kAgainstCounts = 4;  // what speaks against a place, to the patches that meet the model

std::vector<PoseHypothesis> planeHypotheses(const CoarseMap& coarse, const cv::Mat& depth) {
  const std::vector<SurfacePatch> view = coarse.patchesOf(depth);
  const auto rotations = rotationHypotheses(
      dominantDirections(normalsOf(view), kShareOfView, kDirectionsOfView),
      dominantDirections(normalsOf(coarse.patches()), kShareOfModel, kDirectionsOfModel), kRotations);
  return poseHypotheses(view, coarse.patches(), rotations, kAligned);
}

/// Where the surfaces in the image lie on known ones and not where there was nothing, the likeliest first.
std::vector<Pose> likelyHypotheses(const CoarseMap& coarse, const KnownFreeSpace& free_space,
                                   const cv::Mat& depth) {
  const std::vector<PoseHypothesis> places = planeHypotheses(coarse, depth);
  std::vector<Pose> poses;
  for (const PoseHypothesis& place : places) poses.push_back(place.world_from_camera);
  const std::vector<double> against = free_space.quickScore(depth, poses);
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

bool Relocaliser::addKeyframe(const Pose& pose) {
  const auto near = [&](const Pose& keyframe) {
    return areNear(keyframe, pose, kKeyframeShift, kKeyframeTurn);
  };
  if (std::any_of(keyframes_.begin(), keyframes_.end(), near)) return false;
  keyframes_.push_back(pose);
  return true;
}

void Relocaliser::rebase(std::span<const Pose> keyframes) {
  keyframes_.clear();
  for (const Pose& keyframe : keyframes) addKeyframe(keyframe);
}

TrackResult Relocaliser::find(const PreprocessPass& frame, const cv::Mat& depth, const Volume& volume,
                              const CoarseMap& coarse, const KnownFreeSpace& free_space,
                              const TrackHistory& before, double timestamp, const SearchObserver& observer) {
  // Where it is expected is followed, whatever the keyframes' surroundings promise.
  auto [centres, followed] = before.expectedPoses(timestamp);
  for (std::size_t i = 0; i < std::min(kSearchedAtOnce, keyframes_.size()); ++i)
    centres.push_back(keyframes_[searched_++ % keyframes_.size()]);
  const std::vector<Pose> more =
      alignCoarsely(refiner_, settings_, frame, coarse.volume(), likelyHypotheses(coarse, free_space, depth));
  TrackResult found =
      searchAround(search_, refiner_, settings_, frame, volume, centres, followed, observer, more);
  searchAlongNormals(refiner_, settings_, volume, found);
  return found;
}

}  // namespace rosefusion
