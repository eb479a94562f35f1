#include "host/slam/mapping/surface_patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr int kAcross = 80;               // normals over the image's width
constexpr double kFlat = 0.02;            // of the depth: how far the middle may be off the straight line
const double kWithin = std::cos(0.2);     // of one direction
const double kApart = std::cos(0.35);     // of two
constexpr double kAngleTolerance = 0.14;  // between the angles of two pairs
constexpr double kSameRotation = 0.15;
constexpr double kNearlyParallel = 0.85;  // two such directions say little about a rotation

Eigen::Matrix3d frameOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Matrix3d frame;
  frame.col(0) = (a + b).normalized();
  frame.col(1) = (a - b).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

double explained(const Eigen::Matrix3d& rotation, std::span<const SurfaceDirection> view,
                 std::span<const SurfaceDirection> model) {
  double share = 0;
  for (const SurfaceDirection& seen : view)
    if (std::any_of(model.begin(), model.end(), [&](const SurfaceDirection& known) {
          return known.normal.dot(rotation * seen.normal) > kWithin;
        }))
      share += seen.share;
  return share;
}

}  // namespace

std::vector<SurfacePatch> surfacePatches(const cv::Mat& depth, const Intrinsics& camera) {
  const int step = std::max(1, depth.cols / kAcross), reach = std::max(2, depth.cols / 40);
  const auto point = [&](int u, int v) -> Eigen::Vector3d {
    return camera.unproject(u, v, depth.at<float>(v, u));
  };
  std::vector<SurfacePatch> patches;
  for (int v = reach; v + reach < depth.rows; v += step)
    for (int u = reach; u + reach < depth.cols; u += step) {
      const Eigen::Vector3d middle = point(u, v), left = point(u - reach, v), right = point(u + reach, v),
                            above = point(u, v - reach), below = point(u, v + reach);
      if (std::min({middle.z(), left.z(), right.z(), above.z(), below.z()}) <= 0) continue;
      const double most = kFlat * middle.z();
      // Inverse depth is linear in the image along a plane.
      const auto off = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return std::abs(2 / (1 / a.z() + 1 / b.z()) - middle.z());
      };
      if (off(left, right) > most || off(above, below) > most) continue;
      const Eigen::Vector3d normal = (right - left).cross(below - above).normalized();
      patches.push_back({middle, normal.dot(middle) < 0 ? normal : Eigen::Vector3d(-normal)});
    }
  return patches;
}

std::vector<Eigen::Vector3d> normalsOf(std::span<const SurfacePatch> patches) {
  std::vector<Eigen::Vector3d> normals;
  normals.reserve(patches.size());
  for (const SurfacePatch& patch : patches) normals.push_back(patch.normal);
  return normals;
}

std::vector<SurfaceDirection> dominantDirections(std::span<const Eigen::Vector3d> normals, double least_share,
                                                 std::size_t most) {
  std::vector<SurfaceDirection> found;
  std::vector<Eigen::Vector3d> left(normals.begin(), normals.end());
  const auto around = [&](const Eigen::Vector3d& direction) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
    for (const Eigen::Vector3d& n : left)
      if (n.dot(direction) > kWithin) {
        sum += n;
        ++count;
      }
    return std::pair(sum, count);
  };
  while (found.size() < most && !left.empty()) {
    SurfaceDirection best;
    // A few of them are tried as centres: a direction with a share worth having is among these.
    const std::size_t every = std::max<std::size_t>(1, left.size() / 200);
    std::size_t most_around = 0;
    for (std::size_t i = 0; i < left.size(); i += every)
      if (const auto [sum, count] = around(left[i]); count > most_around) {
        most_around = count;
        best.normal = sum.normalized();
      }
    for (int i = 0; i < 3; ++i)
      if (const auto [sum, count] = around(best.normal); count > 0) best.normal = sum.normalized();
    best.share = static_cast<double>(most_around) / static_cast<double>(normals.size());
    if (best.share < least_share) break;
    found.push_back(best);
    std::erase_if(left, [&](const Eigen::Vector3d& n) { return n.dot(best.normal) > kApart; });
  }
  return found;
}

std::vector<Eigen::Matrix3d> rotationHypotheses(std::span<const SurfaceDirection> view,
                                                std::span<const SurfaceDirection> model, std::size_t most) {
  struct Candidate {
    Eigen::Matrix3d rotation;
    double share;
  };
  std::vector<Candidate> candidates;
  for (std::size_t a = 0; a < view.size(); ++a)
    for (std::size_t b = a + 1; b < view.size(); ++b) {
      const double angle = std::acos(std::clamp(view[a].normal.dot(view[b].normal), -1.0, 1.0));
      if (std::abs(std::cos(angle)) > kNearlyParallel) continue;
      for (const SurfaceDirection& c : model)
        for (const SurfaceDirection& d : model) {
          const double other = std::acos(std::clamp(c.normal.dot(d.normal), -1.0, 1.0));
          if (&c == &d || std::abs(angle - other) > kAngleTolerance) continue;
          const Eigen::Matrix3d rotation =
              frameOf(c.normal, d.normal) * frameOf(view[a].normal, view[b].normal).transpose();
          candidates.push_back({rotation, explained(rotation, view, model)});
        }
    }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.share > b.share; });
  std::vector<Eigen::Matrix3d> kept;
  for (const Candidate& candidate : candidates) {
    if (kept.size() == most) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const Eigen::Matrix3d& other) {
          return turnBetween(other, candidate.rotation) < kSameRotation;
        }))
      kept.push_back(candidate.rotation);
  }
  return kept;
}

}  // namespace rosefusion
