#include "host/overview.h"

namespace rosefusion {
namespace {

constexpr float kCoarser = 4;        // than the model's voxels
constexpr float kTruncation = 0.4f;  // a swarm of 3072 particles over a ball of 2 m finds this
constexpr std::size_t kNormalsOfFrame = 200, kDirectionsOfView = 5, kDirectionsOfModel = 20, kRotations = 48;

constexpr double kShareOfView = 0.04, kShareOfModel = 0.008;

VolumeOptions optionsOf(const VolumeSettings& s) {
  const float voxel = kCoarser * static_cast<float>(s.voxel_size);
  return {voxel, std::max(kTruncation, 3 * voxel), static_cast<float>(s.max_weight)};
}

}  // namespace

Overview::Overview(Device& device, const Settings& settings, const Intrinsics& camera,
                   double depth_units_per_metre)
    : camera_(camera),
      range_(settings.depth),
      units_(depth_units_per_metre),
      volume_(device, optionsOf(settings.volume)) {}

cv::Mat Overview::metresOf(const cv::Mat& depth) const {
  cv::Mat metres;
  depth.convertTo(metres, CV_32F, 1 / units_);
  metres.setTo(0, (metres < range_.min) | (metres > range_.max));
  return metres;
}

void Overview::add(FrameFuser& fuser, Recorder& recorder, const cv::Mat& depth,
                   const Pose& world_from_camera) {
  fuser.fuse(recorder, volume_, world_from_camera);
  const std::vector<Eigen::Vector3d> normals = surfaceNormals(metresOf(depth), camera_);
  const std::size_t every = std::max<std::size_t>(1, normals.size() / kNormalsOfFrame);
  for (std::size_t i = 0; i < normals.size(); i += every)
    normals_.push_back(world_from_camera.linear() * normals[i]);
}

std::vector<Eigen::Matrix3d> Overview::rotationsOf(const cv::Mat& depth) const {
  return agreeingRotations(
      dominantDirections(surfaceNormals(metresOf(depth), camera_), kShareOfView, kDirectionsOfView),
      dominantDirections(normals_, kShareOfModel, kDirectionsOfModel), kRotations);
}

}  // namespace rosefusion
