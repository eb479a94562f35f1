#include "host/slam/mapping/keyframes.h"

#include <algorithm>

namespace rosefusion {
namespace {

constexpr double kKeyframeShift = 0.4, kKeyframeTurn = 0.4;  // a keyframe is added where none is within this
constexpr std::size_t kPatchesOfFrame = 200;

void place(Keyframe& keyframe, const Pose& world_from_camera) {
  keyframe.world_from_camera = world_from_camera;
  keyframe.camera_from_world = world_from_camera.inverse();
}

}  // namespace

cv::Mat thumbnailOf(const cv::Mat& metres) {
  cv::Mat small(metres.rows / kThumbnailStride, metres.cols / kThumbnailStride, CV_32F);
  for (int v = 0; v < small.rows; ++v)
    for (int u = 0; u < small.cols; ++u)
      small.at<float>(v, u) = metres.at<float>(v * kThumbnailStride, u * kThumbnailStride);
  return small;
}

void Keyframes::setLast(const cv::Mat& metres, const Pose& world_from_camera, std::size_t frame) {
  last_.frame = frame;
  last_.thumbnail = thumbnailOf(metres);
  place(last_, world_from_camera);
}

bool Keyframes::offer(const cv::Mat& metres, const Pose& world_from_camera, std::size_t frame) {
  if (std::any_of(all_.begin(), all_.end(), [&](const Keyframe& keyframe) {
        return areNear(keyframe.world_from_camera, world_from_camera, kKeyframeShift, kKeyframeTurn);
      }))
    return false;
  Keyframe& added = all_.emplace_back();
  added.frame = frame;
  place(added, world_from_camera);
  if (metres.empty()) return true;
  added.thumbnail = thumbnailOf(metres);
  const std::vector<SurfacePatch> patches = patchesOf(metres);
  const std::size_t every = std::max<std::size_t>(1, patches.size() / kPatchesOfFrame);
  for (std::size_t i = 0; i < patches.size(); i += every) added.patches.push_back(patches[i]);
  return true;
}

std::vector<SurfacePatch> Keyframes::patches() const {
  std::vector<SurfacePatch> out;
  for (const Keyframe& keyframe : all_)
    for (const SurfacePatch& patch : keyframe.patches)
      out.push_back(
          {keyframe.world_from_camera * patch.point, keyframe.world_from_camera.linear() * patch.normal});
  return out;
}

std::vector<SurfacePatch> Keyframes::patchesOf(const cv::Mat& metres) const {
  return surfacePatches(metres, camera_);
}

void Keyframes::move(std::span<const Pose> corrected) {
  for (Keyframe& keyframe : all_) place(keyframe, corrected[keyframe.frame]);
  if (!last_.thumbnail.empty()) place(last_, corrected[last_.frame]);
}

void Keyframes::renumber(std::size_t inserted) {
  for (Keyframe& keyframe : all_) keyframe.frame += keyframe.frame >= inserted;
  last_.frame += last_.frame >= inserted;
}

void Keyframes::clear() {
  all_.clear();
  last_ = {};
}

}  // namespace rosefusion
