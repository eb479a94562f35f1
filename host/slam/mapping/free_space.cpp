#include "host/slam/mapping/free_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr int kStride = 8;  // of the pixels asked about
// How far before the surface that was seen there something must be: in metres and as a share of its depth,
// for poses and edges, and in standard deviations of the two depths' difference.
constexpr double kMargin = 0.1, kMarginShare = 0.05, kMarginDeviations = 3;
constexpr int kGlances = 10;  // over the image's width
constexpr double kGlanceMargin = 2.5;
constexpr int kFewKnown = 10;  // pixels of earlier images in view say little about a pose

}  // namespace

double KnownFreeSpace::margin(double z, double seen) const {
  const double deviation = std::hypot(range_.deviationAt(z), range_.deviationAt(seen));
  return std::max({kMargin, kMarginShare * z, kMarginDeviations * deviation});
}

bool KnownFreeSpace::seesThrough(const Keyframe& view, const Eigen::Vector3d& world, double scale) const {
  const Eigen::Vector3d p = view.camera_from_world * world;
  if (p.z() <= 0) return false;
  const Eigen::Vector2d pixel = camera_.project(p) / kThumbnailStride;
  // The four around it and, a pose being a little wrong, no border.
  if (!(pixel.x() >= 1 && pixel.y() >= 1 && pixel.x() < view.thumbnail.cols - 2 &&
        pixel.y() < view.thumbnail.rows - 2))
    return false;
  const int u = static_cast<int>(pixel.x()), v = static_cast<int>(pixel.y());
  const auto at = [&](int x, int y) { return view.thumbnail.at<float>(y, x); };
  const double nearest = std::min({at(u, v), at(u + 1, v), at(u, v + 1), at(u + 1, v + 1)});
  return nearest - p.z() > scale * margin(p.z(), nearest);
}

bool KnownFreeSpace::shows(const Keyframe& view, const Eigen::Vector3d& world, double scale) const {
  const Eigen::Vector3d p = view.camera_from_world * world;
  if (p.z() <= 0) return false;
  const Eigen::Vector2d pixel = camera_.project(p) / kThumbnailStride;
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  if (u < 0 || v < 0 || u >= view.thumbnail.cols || v >= view.thumbnail.rows) return false;
  const double seen = view.thumbnail.at<float>(v, u);
  return seen > 0 && std::abs(seen - p.z()) < scale * margin(p.z(), seen);
}

template <typename Test>
double KnownFreeSpace::shareWhere(const cv::Mat& depth, const Pose& world_from_camera, int stride,
                                  const Test& test) const {
  int valid = 0, through = 0;
  for (int v = stride / 2; v < depth.rows; v += stride)
    for (int u = stride / 2; u < depth.cols; u += stride) {
      const double z = depth.at<float>(v, u);
      if (z == 0) continue;
      ++valid;
      through += test(world_from_camera * camera_.unproject(u, v, z));
    }
  return valid ? static_cast<double>(through) / valid : 0;
}

double KnownFreeSpace::violationOfLast(const cv::Mat& depth, const Pose& world_from_camera) const {
  if (keyframes_.last().thumbnail.empty()) return 0;
  return shareWhere(depth, world_from_camera, kStride,
                    [&](const Eigen::Vector3d& world) { return seesThrough(keyframes_.last(), world); });
}

double KnownFreeSpace::violation(const cv::Mat& depth, const Pose& world_from_camera) const {
  return violation(depth, world_from_camera, kStride, 1);
}

double KnownFreeSpace::violation(const cv::Mat& depth, const Pose& world_from_camera, int stride,
                                 double margin) const {
  return shareWhere(depth, world_from_camera, stride, [&](const Eigen::Vector3d& world) {
    return std::any_of(keyframes_.all().begin(), keyframes_.all().end(),
                       [&](const Keyframe& view) { return seesThrough(view, world, margin); });
  });
}

template <typename Visit>
void KnownFreeSpace::eachSurface(const Keyframe& view, int stride, const Visit& visit) const {
  for (int v = stride / 2; v < view.thumbnail.rows; v += stride)
    for (int u = stride / 2; u < view.thumbnail.cols; u += stride)
      if (const double z = view.thumbnail.at<float>(v, u); z > 0)
        visit(view.world_from_camera * camera_.unproject(u * kThumbnailStride, v * kThumbnailStride, z));
}

void KnownFreeSpace::Missing::look(const KnownFreeSpace& seen, const Keyframe& now,
                                   const Eigen::Vector3d& world, double margin) {
  const bool through = seen.seesThrough(now, world, margin);
  missing += through;
  expected += through || seen.shows(now, world, margin);
}

double KnownFreeSpace::missingSurface(const cv::Mat& depth, const Pose& world_from_camera) const {
  Keyframe now;
  now.thumbnail = thumbnailOf(depth);
  now.camera_from_world = world_from_camera.inverse();
  Missing of;
  for (const Keyframe& view : keyframes_.all())
    eachSurface(view, kStride / kThumbnailStride,
                [&](const Eigen::Vector3d& world) { of.look(*this, now, world, 1); });
  return of.share(1);
}

std::vector<double> KnownFreeSpace::quickScore(const cv::Mat& depth, std::span<const Pose> places) const {
  std::vector<Eigen::Vector3d> known;
  for (const Keyframe& view : keyframes_.all())
    eachSurface(view, std::max(1, view.thumbnail.cols / kGlances),
                [&](const Eigen::Vector3d& world) { known.push_back(world); });
  Keyframe now;
  now.thumbnail = thumbnailOf(depth);
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
