#include "host/slam/mapping/free_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr int kStride = 8;      // of the pixels asked about
constexpr int kKeptStride = 4;  // of those remembered
// How far before the surface that was seen there something must be: in metres and as a share of its depth,
// for poses and edges, and in standard deviations of the two depths' difference.
constexpr double kMargin = 0.1, kMarginShare = 0.05, kMarginDeviations = 3;
constexpr int kGlances = 10;  // over the image's width
constexpr double kGlanceMargin = 2.5;
constexpr int kFewKnown = 10;  // pixels of earlier images in view say little about a pose
// A view is worth keeping where none is within this.
constexpr double kViewShift = 0.4, kViewTurn = 0.4;

}  // namespace

double KnownFreeSpace::metresAt(const cv::Mat& depth, int u, int v) const {
  const double z = depth.at<std::uint16_t>(v, u) / units_;
  return z >= range_.min && z <= range_.max ? z : 0;
}

double KnownFreeSpace::margin(double z, double seen) const {
  const double deviation = std::hypot(range_.deviationAt(z), range_.deviationAt(seen));
  return std::max({kMargin, kMarginShare * z, kMarginDeviations * deviation});
}

KnownFreeSpace::View KnownFreeSpace::shrunk(const cv::Mat& depth, const Pose& world_from_camera) const {
  cv::Mat small(depth.rows / kKeptStride, depth.cols / kKeptStride, CV_32F);
  for (int v = 0; v < small.rows; ++v)
    for (int u = 0; u < small.cols; ++u)
      small.at<float>(v, u) = static_cast<float>(metresAt(depth, u * kKeptStride, v * kKeptStride));
  return {small, world_from_camera, world_from_camera.inverse()};
}

void KnownFreeSpace::keep(const cv::Mat& depth, const Pose& world_from_camera, std::size_t frame) {
  last_ = shrunk(depth, world_from_camera);
  last_.frame = frame;
  if (std::none_of(keyframes_.begin(), keyframes_.end(), [&](const View& view) {
        return areNear(view.world_from_camera, world_from_camera, kViewShift, kViewTurn);
      }))
    keyframes_.push_back(last_);
}

void KnownFreeSpace::rebase(std::span<const Pose> frame_poses) {
  const auto move = [&](View& view) {
    view.world_from_camera = frame_poses[view.frame];
    view.camera_from_world = view.world_from_camera.inverse();
  };
  if (!last_.depth.empty()) move(last_);
  for (View& view : keyframes_) move(view);
}

bool KnownFreeSpace::seesThrough(const View& view, const Eigen::Vector3d& world, double scale) const {
  const Eigen::Vector3d p = view.camera_from_world * world;
  if (p.z() <= 0) return false;
  const Eigen::Vector2d pixel = camera_.project(p) / kKeptStride;
  // The four around it and, a pose being a little wrong, no border.
  if (!(pixel.x() >= 1 && pixel.y() >= 1 && pixel.x() < view.depth.cols - 2 &&
        pixel.y() < view.depth.rows - 2))
    return false;
  const int u = static_cast<int>(pixel.x()), v = static_cast<int>(pixel.y());
  const auto at = [&](int x, int y) { return view.depth.at<float>(y, x); };
  const double nearest = std::min({at(u, v), at(u + 1, v), at(u, v + 1), at(u + 1, v + 1)});
  return nearest - p.z() > scale * margin(p.z(), nearest);
}

bool KnownFreeSpace::shows(const View& view, const Eigen::Vector3d& world, double scale) const {
  const Eigen::Vector3d p = view.camera_from_world * world;
  if (p.z() <= 0) return false;
  const Eigen::Vector2d pixel = camera_.project(p) / kKeptStride;
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  if (u < 0 || v < 0 || u >= view.depth.cols || v >= view.depth.rows) return false;
  const double seen = view.depth.at<float>(v, u);
  return seen > 0 && std::abs(seen - p.z()) < scale * margin(p.z(), seen);
}

template <typename Test>
double KnownFreeSpace::shareWhere(const cv::Mat& depth, const Pose& world_from_camera, int stride,
                                  const Test& test) const {
  int valid = 0, through = 0;
  for (int v = stride / 2; v < depth.rows; v += stride)
    for (int u = stride / 2; u < depth.cols; u += stride) {
      const double z = metresAt(depth, u, v);
      if (z == 0) continue;
      ++valid;
      through += test(world_from_camera * camera_.unproject(u, v, z));
    }
  return valid ? static_cast<double>(through) / valid : 0;
}

double KnownFreeSpace::violationOfLast(const cv::Mat& depth, const Pose& world_from_camera) const {
  if (last_.depth.empty()) return 0;
  return shareWhere(depth, world_from_camera, kStride,
                    [&](const Eigen::Vector3d& world) { return seesThrough(last_, world); });
}

double KnownFreeSpace::violation(const cv::Mat& depth, const Pose& world_from_camera) const {
  return violation(depth, world_from_camera, kStride, 1);
}

double KnownFreeSpace::violation(const cv::Mat& depth, const Pose& world_from_camera, int stride,
                                 double margin) const {
  return shareWhere(depth, world_from_camera, stride, [&](const Eigen::Vector3d& world) {
    return std::any_of(keyframes_.begin(), keyframes_.end(),
                       [&](const View& view) { return seesThrough(view, world, margin); });
  });
}

template <typename Visit>
void KnownFreeSpace::eachSurface(const View& view, int stride, const Visit& visit) const {
  for (int v = stride / 2; v < view.depth.rows; v += stride)
    for (int u = stride / 2; u < view.depth.cols; u += stride)
      if (const double z = view.depth.at<float>(v, u); z > 0)
        visit(view.world_from_camera * camera_.unproject(u * kKeptStride, v * kKeptStride, z));
}

void KnownFreeSpace::Missing::look(const KnownFreeSpace& seen, const View& now, const Eigen::Vector3d& world,
                                   double margin) {
  const bool through = seen.seesThrough(now, world, margin);
  missing += through;
  expected += through || seen.shows(now, world, margin);
}

double KnownFreeSpace::missingSurface(const cv::Mat& depth, const Pose& world_from_camera) const {
  const View now = shrunk(depth, world_from_camera);
  Missing of;
  for (const View& view : keyframes_)
    eachSurface(view, kStride / kKeptStride,
                [&](const Eigen::Vector3d& world) { of.look(*this, now, world, 1); });
  return of.share(1);
}

std::vector<double> KnownFreeSpace::quickScore(const cv::Mat& depth, std::span<const Pose> places) const {
  std::vector<Eigen::Vector3d> known;
  for (const View& view : keyframes_)
    eachSurface(view, std::max(1, view.depth.cols / kGlances),
                [&](const Eigen::Vector3d& world) { known.push_back(world); });
  View now = shrunk(depth, Pose::Identity());
  std::vector<double> against;
  for (const Pose& place : places) {
    now.camera_from_world = place.inverse();
    Missing of;
    for (const Eigen::Vector3d& world : known) of.look(*this, now, world, kGlanceMargin);
    against.push_back(violation(depth, place, std::max(kStride, depth.cols / kGlances), kGlanceMargin) +
                      of.share(kFewKnown));
  }
  return against;
}

}  // namespace rosefusion
