#include "tests/engine/surface_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>
#include <limits>

#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace {

constexpr double kUnitsPerMetre = 10000;  // fine enough not to matter; up to 6.5 m
constexpr float kMinDepth = 0.1f, kMaxDepth = 6.0f;
constexpr int kWidth = 320, kHeight = 240;
constexpr float kFocal = 160;  // a quarter turn across

shader::CameraIntrinsics sceneCamera() {
  return {glm::vec4(kFocal, kFocal, 0.5f * (kWidth - 1), 0.5f * (kHeight - 1)),
          glm::ivec4(kWidth, kHeight, 0, 0)};
}

VolumeOptions volumeOptions(const SceneOptions& options) {
  VolumeOptions out;
  out.voxel_size = options.voxel_size;
  out.truncation = 3 * options.voxel_size;
  out.colour = options.colour;
  return out;
}

}  // namespace

double sphereInBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const double along = origin.dot(direction);
  const double under_root = along * along - origin.squaredNorm() + kSphereRadius * kSphereRadius;
  if (under_root >= 0 && along < 0) return -along - std::sqrt(under_root);
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    if (direction[axis] != 0)
      nearest =
          std::min(nearest, (std::copysign(kBoxHalf, direction[axis]) - origin[axis]) / direction[axis]);
  return nearest;
}

Eigen::Isometry3d lookAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - position).normalized();
  const Eigen::Vector3d right = forward.unitOrthogonal();
  Eigen::Isometry3d pose;
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = position;
  pose.makeAffine();
  return pose;
}

std::vector<Eigen::Isometry3d> posesAllAround() {
  std::vector<Eigen::Isometry3d> poses;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const int directions = std::abs(x) + std::abs(y) + std::abs(z);
        if (directions == 1 || directions == 3)
          poses.push_back(
              lookAt(kCameraDistance * Eigen::Vector3d(x, y, z).normalized(), Eigen::Vector3d::Zero()));
      }
  return poses;
}

glm::mat4 toGlm(const Eigen::Isometry3d& pose) {
  glm::mat4 out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      out[column][row] = static_cast<float>(pose.matrix()(row, column));
  return out;
}

SurfaceScene::SurfaceScene(Device& device, const SceneOptions& options)
    : camera(sceneCamera()),
      volume(device, volumeOptions(options)),
      recorder(device),
      preprocess_(device, camera),
      allocate_(device),
      integrate_(device),
      colour_(options.colour) {}

void SurfaceScene::fuse(const Eigen::Isometry3d& world_from_camera, const Distance& distance) {
  std::vector<std::uint16_t> depth;
  std::vector<std::uint32_t> rgb;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const Eigen::Vector3d ray((u - camera.focal_centre.z) / kFocal, (v - camera.focal_centre.w) / kFocal,
                                1);
      const Eigen::Vector3d direction = world_from_camera.linear() * ray.normalized();
      const double d = distance(world_from_camera.translation(), direction);
      depth.push_back(static_cast<std::uint16_t>(std::lround(d / ray.norm() * kUnitsPerMetre)));
      const Eigen::Vector3d point = world_from_camera.translation() + d * direction;
      rgb.push_back(point.norm() < 1.1 * kSphereRadius ? kSphereColour : kBoxColour);
    }
  if (colour_) {
    std::ranges::copy(rgb, preprocess_.colourWords().begin());
    preprocess_.recordColour(recorder);
  }
  const glm::mat4 pose = toGlm(world_from_camera);
  do {
    preprocess_.record(recorder, depth, float(1 / kUnitsPerMetre), kMinDepth, kMaxDepth);
    allocate_.record(recorder, volume, preprocess_.frame(), camera, pose);
    recorder.submit();
  } while (allocate_.finish(recorder, volume));
  integrate_.record(recorder, volume, preprocess_.frame(), camera, glm::inverse(pose), kMaxDepth);
  recorder.submit();
}

reference::Field SurfaceScene::field(double stretch) {
  const VolumeContents contents = volume.download();
  std::vector<Eigen::Vector3i> blocks;
  for (const glm::ivec4& block : contents.blocks) blocks.emplace_back(block.x, block.y, block.z);
  // Slot 0 is no block of the scene.
  return {std::span(blocks).subspan(1), std::span(contents.tsdf).subspan(shader::kBlockVoxels),
          std::span(contents.weight).subspan(shader::kBlockVoxels), stretch * volume.options().voxel_size};
}

SurfaceTest::SurfaceTest() : device(deviceUnderTest()) {}

void SurfaceTest::TearDown() {
  EXPECT_TRUE(device.validationMessages().empty()) << device.validationMessages().front();
}

}  // namespace rosefusion::testing
