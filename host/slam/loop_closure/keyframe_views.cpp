#include "host/slam/loop_closure/keyframe_views.h"

#include <cmath>

namespace rosefusion {
namespace {

constexpr int kColumns = 20, kRows = 15;
// By how much a depth may differ, in metres and as a share: drift, and what lies between two grid points.
constexpr double kMargin = 0.2, kMarginShare = 0.1;
constexpr double kMostZoom = 2;    // seen from twice as far, a surface looks different
constexpr double kMostTurn = 1.1;  // radians between the views: surfaces have a front and a back

}  // namespace

void KeyframeViews::add(const cv::Mat& metres) {
  View view;
  view.depth = cv::Mat::zeros(kRows, kColumns, CV_32F);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const int u = (2 * column + 1) * metres.cols / (2 * kColumns);
      const int v = (2 * row + 1) * metres.rows / (2 * kRows);
      const float z = metres.at<float>(v, u);
      if (z == 0) continue;
      view.depth.at<float>(row, column) = z;
      view.points.push_back(camera_.unproject(u, v, z).cast<float>());
    }
  views_.push_back(std::move(view));
}

double KeyframeViews::overlap(std::size_t newest, std::size_t old, const Pose& old_from_newest) const {
  const std::vector<Eigen::Vector3f>& points = views_[newest].points;
  const cv::Mat& depth = views_[old].depth;
  if (points.empty() || rotationAngle(old_from_newest) > kMostTurn) return 0;
  int shared = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = old_from_newest * point.cast<double>();
    if (p.z() < point.z() / kMostZoom || p.z() > point.z() * kMostZoom) continue;
    const Eigen::Vector2d pixel = camera_.project(p);
    const int column = static_cast<int>(std::floor((pixel.x() + 0.5) * kColumns / camera_.width));
    const int row = static_cast<int>(std::floor((pixel.y() + 0.5) * kRows / camera_.height));
    if (column < 0 || row < 0 || column >= kColumns || row >= kRows) continue;
    const double seen = depth.at<float>(row, column);
    shared += seen > 0 && std::abs(seen - p.z()) < kMargin + kMarginShare * p.z();
  }
  return double(shared) / double(points.size());
}

}  // namespace rosefusion
