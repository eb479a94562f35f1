#include "host/run/preview.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "engine/passes/raycast.h"
#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

const Intrinsics kView{1280, 800, 1150, 1150, 639.5, 399.5};
constexpr double kElevation = 0.95;  // radians above the horizon
constexpr double kFill =
    1.3;  // bounding sphere over picture height; above 1, because rooms are flatter than spheres
constexpr double kOutlierShare = 0.01;  // blocks cut at each end of an axis: stray depth far outside
constexpr double kPathReach = 0.95;     // of the way to the picture's edge
constexpr int kLineWidth = 2;

struct Sphere {
  Eigen::Vector3d centre;
  double radius;
};

/// Sphere about the model in axes with z up, without the farthest stray blocks.
Sphere boundingSphere(const Volume& volume, const Eigen::Matrix3d& upright_from_world) {
  const double side = shader::kBlockSide * volume.options().voxel_size;
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& block : volume.blocks().subspan(1))
      values.push_back(
          upright_from_world.row(axis).dot(Eigen::Vector3d(block.x + 0.5, block.y + 0.5, block.z + 0.5)) *
          side);
    std::sort(values.begin(), values.end());
    const auto cut = static_cast<std::size_t>(kOutlierShare * values.size());
    low[axis] = values[cut];
    high[axis] = values[values.size() - 1 - cut];
  }
  return {upright_from_world.transpose() * (low + high) / 2, (high - low).norm() / 2};
}

void drawPath(cv::Mat& picture, const Trajectory& trajectory, std::span<const double> shades,
              const Pose& view_from_world) {
  cv::Mat ramp(1, 256, CV_8UC1), colours;
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  cv::applyColorMap(ramp, colours, shades.empty() ? cv::COLORMAP_TURBO : cv::COLORMAP_VIRIDIS);
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Eigen::Vector3d a = view_from_world * trajectory[i - 1].world_from_camera.translation();
    const Eigen::Vector3d b = view_from_world * trajectory[i].world_from_camera.translation();
    if (a.z() <= 0 || b.z() <= 0) continue;
    const Eigen::Vector2d from = kView.project(a), to = kView.project(b);
    const std::size_t shade = shades.empty()
                                  ? 255 * i / trajectory.size()
                                  : static_cast<std::size_t>(255 * std::clamp(shades[i], 0.0, 1.0));
    const auto& c = colours.at<cv::Vec3b>(static_cast<int>(shade));
    cv::line(picture, cv::Point2d(from.x(), from.y()), cv::Point2d(to.x(), to.y()),
             cv::Scalar(c[0], c[1], c[2]), kLineWidth, cv::LINE_AA);
  }
}

}  // namespace

Pose overviewPose(const Volume& volume, const Trajectory& trajectory, const Intrinsics& view) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), forward = Eigen::Vector3d::Zero();
  for (const StampedPose& p : trajectory) {
    up -= p.world_from_camera.linear().col(1);
    forward += p.world_from_camera.linear().col(2);
  }
  if (up.norm() < 1e-6) up = -Eigen::Vector3d::UnitY();
  up.normalize();
  forward -= up * up.dot(forward);
  if (forward.norm() < 1e-6) forward = up.unitOrthogonal();
  forward.normalize();

  Eigen::Matrix3d upright_from_world;
  upright_from_world << forward.cross(up).transpose(), forward.transpose(), up.transpose();
  const Sphere sphere = boundingSphere(volume, upright_from_world);
  const double distance = sphere.radius * 2 * view.fy / (view.height * kFill);
  const Eigen::Vector3d looking = std::cos(kElevation) * forward - std::sin(kElevation) * up;
  Pose pose = Pose::Identity();
  pose.linear().col(2) = looking;
  pose.linear().col(0) = looking.cross(up).normalized();
  pose.linear().col(1) = looking.cross(pose.linear().col(0));
  pose.translation() = sphere.centre - distance * looking;
  // A hand-held camera often stands outside of what it sees; its path is to be in the picture all the same.
  const Pose view_from_world = pose.inverse();
  double back = 0;
  for (const StampedPose& p : trajectory) {
    const Eigen::Vector3d at = view_from_world * p.world_from_camera.translation();
    const double least_depth = std::max(2 * view.fx * std::abs(at.x()) / (kPathReach * view.width),
                                        2 * view.fy * std::abs(at.y()) / (kPathReach * view.height));
    back = std::max(back, least_depth - at.z());
  }
  pose.translation() -= back * looking;
  return pose;
}

cv::Mat renderOverview(Pipeline& pipeline, const Trajectory& trajectory, std::span<const double> shades) {
  const Pose pose = overviewPose(pipeline.volume(), trajectory, kView);
  RaycastPass raycast(pipeline.device(), toShader(kView));
  Recorder recorder(pipeline.device());
  RaycastView view;
  view.world_from_camera = toShader(pose);
  view.far = 1000;
  raycast.record(recorder, pipeline.volume(), view);
  recorder.submit();
  cv::Mat picture(kView.height, kView.width, CV_8UC3);
  const auto words = raycast.preview();
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column) {
      const std::uint32_t w = words[static_cast<std::size_t>(row) * picture.cols + column];
      picture.at<cv::Vec3b>(row, column) = {static_cast<std::uint8_t>(w >> 16),
                                            static_cast<std::uint8_t>(w >> 8), static_cast<std::uint8_t>(w)};
    }
  drawPath(picture, trajectory, shades, pose.inverse());
  return picture;
}

}  // namespace rosefusion
