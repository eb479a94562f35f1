#include "host/export/texture/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace rosefusion {
namespace {

constexpr float kNearest = 0.05f;  // metres; what is closer is behind the camera
constexpr float kFar = std::numeric_limits<float>::max();
constexpr int kMargin = 2;  // pixels by which images and mesh may disagree

/// A triangle as the camera sees it: pixels, and the depths of its vertices.
struct Projected {
  Eigen::Vector2f pixel[3];
  float depth[3];
  float twice_area = 0;
};

class View {
 public:
  View(const TriangleMesh& mesh, const Intrinsics& camera, const Pose& world_from_camera)
      : mesh_(mesh), width_(camera.width), height_(camera.height) {
    const Eigen::Isometry3f camera_from_world = world_from_camera.inverse().cast<float>();
    points_.reserve(mesh.vertices.size());
    for (const Eigen::Vector3f& v : mesh.vertices) {
      const Eigen::Vector3f p = camera_from_world * v;
      const float z = std::max(p.z(), kNearest);
      points_.emplace_back(static_cast<float>(camera.fx) * p.x() / z + static_cast<float>(camera.cx),
                           static_cast<float>(camera.fy) * p.y() / z + static_cast<float>(camera.cy), p.z());
    }
  }

  /// False where it is behind the camera or beside the image.
  bool project(std::size_t triangle, Projected& out) const {
    Eigen::Vector2f low, high;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = points_[mesh_.triangles[triangle][static_cast<std::size_t>(i)]];
      if (p.z() <= kNearest) return false;
      out.pixel[i] = p.head<2>();
      out.depth[i] = p.z();
      low = i ? low.cwiseMin(out.pixel[i]).eval() : out.pixel[i];
      high = i ? high.cwiseMax(out.pixel[i]).eval() : out.pixel[i];
    }
    if (!(high.x() >= 0 && high.y() >= 0 && low.x() <= static_cast<float>(width_ - 1) &&
          low.y() <= static_cast<float>(height_ - 1)))
      return false;
    const Eigen::Vector2f a = out.pixel[1] - out.pixel[0], b = out.pixel[2] - out.pixel[0];
    out.twice_area = a.x() * b.y() - a.y() * b.x();
    return std::abs(out.twice_area) > 1e-9f;
  }

  /// The nearest depth at each pixel's centre; kFar where there is nothing.
  cv::Mat1f nearestDepths() const {
    cv::Mat1f depths(height_, width_, kFar);
    Projected t;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      if (project(i, t)) draw(t, depths);
    return depths;
  }

 private:
  static void draw(const Projected& t, cv::Mat1f& depths) {
    const auto [x0, x1] = std::minmax({t.pixel[0].x(), t.pixel[1].x(), t.pixel[2].x()});
    const auto [y0, y1] = std::minmax({t.pixel[0].y(), t.pixel[1].y(), t.pixel[2].y()});
    const int left = static_cast<int>(std::ceil(std::max(x0, 0.0f)));
    const int right = static_cast<int>(std::floor(std::min(x1, static_cast<float>(depths.cols - 1))));
    const int top = static_cast<int>(std::ceil(std::max(y0, 0.0f)));
    const int bottom = static_cast<int>(std::floor(std::min(y1, static_cast<float>(depths.rows - 1))));
    const auto weight = [&](int i, float x, float y) {
      const Eigen::Vector2f &p = t.pixel[(i + 1) % 3], &q = t.pixel[(i + 2) % 3];
      return ((q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x())) / t.twice_area;
    };
    for (int y = top; y <= bottom; ++y) {
      float* row = depths.ptr<float>(y);
      for (int x = left; x <= right; ++x) {
        const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
        const float a = weight(0, fx, fy), b = weight(1, fx, fy), c = weight(2, fx, fy);
        if (a < 0 || b < 0 || c < 0) continue;
        row[x] = std::min(row[x], 1 / (a / t.depth[0] + b / t.depth[1] + c / t.depth[2]));
      }
    }
  }

  const TriangleMesh& mesh_;
  int width_, height_;
  std::vector<Eigen::Vector3f> points_;  // pixel and depth
};

/// Metres of depth from one pixel to the next.
float slopeOf(const Projected& t) {
  const Eigen::Vector2f a = t.pixel[1] - t.pixel[0], b = t.pixel[2] - t.pixel[0];
  const float da = t.depth[1] - t.depth[0], db = t.depth[2] - t.depth[0];
  return (std::abs(da * b.y() - db * a.y()) + std::abs(db * a.x() - da * b.x())) / std::abs(t.twice_area);
}

/// What is found at points spread over a triangle, some pixels apart.
struct Judgement {
  bool inside = true, hidden = false, near_edge = false;
  int with_depth = 0, contradicted = 0;
};

Judgement judge(const Projected& t, const cv::Mat1f& nearest, const cv::Mat1f& nearest_around,
                const cv::Mat& depth, const SeeingOptions& options) {
  constexpr float kApart = 4;  // pixels
  Judgement out;
  const float slope = slopeOf(t), detail = static_cast<float>(options.detail);
  float longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (t.pixel[i] - t.pixel[(i + 1) % 3]).norm());
  const int steps = std::clamp(static_cast<int>(std::ceil(longest / kApart)), 1, 32);
  for (int i = 0; i <= steps; ++i)
    for (int k = 0; k <= steps - i; ++k) {
      const float a = static_cast<float>(i) / static_cast<float>(steps),
                  b = static_cast<float>(k) / static_cast<float>(steps), c = 1 - a - b;
      const Eigen::Vector2f p = a * t.pixel[0] + b * t.pixel[1] + c * t.pixel[2];
      const float z = 1 / (a / t.depth[0] + b / t.depth[1] + c / t.depth[2]);
      const int x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
      if (x < 1 || y < 1 || x >= nearest.cols - 1 || y >= nearest.rows - 1) {
        out.inside = false;
        return out;
      }
      out.hidden |= z > nearest(y, x) + detail + slope;
      out.near_edge |= z > nearest_around(y, x) + detail + (kMargin + 1) * slope;
      const float measured = depth.at<float>(y, x);
      if (measured <= 0) continue;
      ++out.with_depth;
      out.contradicted += std::abs(measured - z) > options.depth_tolerance(static_cast<double>(z));
    }
  return out;
}

}  // namespace

std::vector<SeenTriangle> seenTriangles(const TriangleMesh& mesh, const Intrinsics& camera,
                                        const TextureView& view, const cv::Mat& depth,
                                        const SeeingOptions& options) {
  const View seen_from(mesh, camera, view.world_from_camera);
  const cv::Mat1f nearest = seen_from.nearestDepths();
  cv::Mat1f nearest_around;
  cv::erode(nearest, nearest_around, cv::Mat::ones(2 * kMargin + 1, 2 * kMargin + 1, CV_8U));
  const Eigen::Vector3f eye = view.world_from_camera.translation().cast<float>();
  std::vector<SeenTriangle> seen;
  Projected projected;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!seen_from.project(i, projected)) continue;
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized(), ray = eye - (a + b + c) / 3;
    const float facing = normal.dot(ray.normalized());
    if (!(facing > 0.1f)) continue;
    const Judgement found = judge(projected, nearest, nearest_around, depth, options);
    if (!found.inside || found.hidden || 2 * found.contradicted > found.with_depth) continue;
    const double sharp = std::abs(camera.fx) * facing / ray.norm() / std::sqrt(1 + view.blur * view.blur);
    seen.push_back({static_cast<std::uint32_t>(i), static_cast<float>(found.near_edge ? sharp / 10 : sharp)});
  }
  return seen;
}

}  // namespace rosefusion
