#include "host/slam/mapping/coarse_map.h"

namespace rosefusion {
namespace {

constexpr float kCoarser = 4;        // than the model's voxels
constexpr float kTruncation = 0.4f;  // places within this descend to the surface
constexpr std::size_t kPatchesOfFrame = 200;

VolumeOptions coarseOptions(const VolumeSettings& s) {
  VolumeOptions out = volumeOptions(s);
  out.voxel_size *= kCoarser;
  out.truncation = std::max(kTruncation, 3 * out.voxel_size);
  out.colour = false;
  out.memory_limit_bytes = 0;
  return out;
}

}  // namespace

CoarseMap::CoarseMap(Device& device, const Settings& settings, const Intrinsics& camera,
                     double depth_units_per_metre)
    : camera_(camera),
      range_(settings.depth),
      units_(depth_units_per_metre),
      volume_(device, coarseOptions(settings.volume)) {}

cv::Mat CoarseMap::metresOf(const cv::Mat& depth) const {
  cv::Mat metres;
  depth.convertTo(metres, CV_32F, 1 / units_);
  metres.setTo(0, (metres < range_.min) | (metres > range_.max));
  return metres;
}

void CoarseMap::add(FrameIntegrator& fuser, Recorder& recorder, const cv::Mat& depth,
                    const Pose& world_from_camera, std::size_t frame) {
  fuser.fuse(recorder, volume_, world_from_camera);
  const std::vector<SurfacePatch> patches = patchesOf(depth);
  const std::size_t every = std::max<std::size_t>(1, patches.size() / kPatchesOfFrame);
  View& view = views_.emplace_back(View{{}, frame});
  for (std::size_t i = 0; i < patches.size(); i += every) view.patches.push_back(patches[i]);
  place(view, world_from_camera);
}

void CoarseMap::place(const View& view, const Pose& world_from_camera) {
  for (const SurfacePatch& patch : view.patches)
    patches_.push_back({world_from_camera * patch.point, world_from_camera.linear() * patch.normal});
}

void CoarseMap::clear() {
  volume_.clear();
  views_.clear();
  patches_.clear();
}

void CoarseMap::rebase(std::span<const Pose> frame_poses) {
  patches_.clear();
  for (const View& view : views_) place(view, frame_poses[view.frame]);
}

std::vector<SurfacePatch> CoarseMap::patchesOf(const cv::Mat& depth) const {
  return surfacePatches(metresOf(depth), camera_);
}

}  // namespace rosefusion
