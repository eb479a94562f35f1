#include "host/synth/free_space.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/core/error.h"
#include "host/synth/parallel.h"

namespace rosefusion {
namespace {

constexpr double kLowest = 0.7, kHighest = 1.9;  // metres above the floor
constexpr double kFarWall = 60;                  // metres; further away counts as outside
constexpr int kLargestGrid = 1500000;            // cells; keeps the grid of a large building within seconds

}  // namespace

FreeSpace::FreeSpace(const Tracer& tracer, int threads, const std::string& source) : tracer_(tracer) {
  const TriangleMesh& mesh = tracer.scene().mesh;
  Eigen::Vector3f low = mesh.vertices[0], high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  low_ = low.cast<double>();
  const Eigen::Vector3d size = (high - low).cast<double>();
  cell_ = std::max(cell_, std::cbrt(size.prod() / kLargestGrid));
  count_ = (size / cell_).array().ceil().cast<int>().max(1);

  const std::int64_t total = std::int64_t(count_.x()) * count_.y() * count_.z();
  std::vector<std::uint8_t> free(total, 0);
  std::vector<float> floors(total, 0);  // height of what lies below each inside cell
  const auto centre = [&](std::int64_t i) -> Eigen::Vector3d {
    const std::int64_t x = i % count_.x(), y = i / count_.x() % count_.y(), z = i / count_.x() / count_.y();
    return low_ + cell_ * (Eigen::Vector3d(double(x), double(y), double(z)) + Eigen::Vector3d::Constant(0.5));
  };
  constexpr int kBatch = 512;
  parallelFor(static_cast<int>((total + kBatch - 1) / kBatch), threads, [&](int batch) {
    for (std::int64_t i = std::int64_t(batch) * kBatch; i < std::min(total, std::int64_t(batch + 1) * kBatch);
         ++i) {
      const Eigen::Vector3d p = centre(i);
      if (!isClear(p, kKeyClearance) || !isInside(p)) continue;
      const auto below = tracer_.cast(p, -up(), kFarWall);
      floors[i] = static_cast<float>(p.dot(up()) - (below ? below->distance : 0));
      free[i] = 1;
    }
  });
  std::vector<float> heights;
  for (std::int64_t i = 0; i < total; ++i)
    if (free[i]) heights.push_back(floors[i]);
  if (!heights.empty()) {
    std::nth_element(heights.begin(), heights.begin() + heights.size() / 2, heights.end());
    floor_ = heights[heights.size() / 2];  // more lies above the floor than above furniture
  }
  for (std::int64_t i = 0; i < total; ++i) {
    const double height = centre(i).dot(up()) - floor_;
    if (height < kLowest || height > kHighest) free[i] = 0;
  }

  // The largest connected part, by flooding.
  index_.assign(total, -1);
  const std::int64_t strides[] = {1, count_.x(), std::int64_t(count_.x()) * count_.y()};
  std::vector<std::int64_t> best, part;
  for (std::int64_t start = 0; start < total; ++start) {
    if (free[start] != 1) continue;
    part.assign(1, start);
    free[start] = 2;
    for (std::size_t next = 0; next < part.size(); ++next) {
      const std::int64_t i = part[next];
      const std::int64_t at[] = {i % count_.x(), i / count_.x() % count_.y(), i / strides[2]};
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          if (at[axis] + step < 0 || at[axis] + step >= count_[axis]) continue;
          const std::int64_t neighbour = i + step * strides[axis];
          if (free[neighbour] != 1) continue;
          free[neighbour] = 2;
          part.push_back(neighbour);
        }
    }
    if (part.size() > best.size()) best.swap(part);
  }
  std::sort(best.begin(), best.end());
  for (const std::int64_t i : best) {
    index_[i] = static_cast<std::int64_t>(cells_.size());
    cells_.push_back(centre(i));
  }
  if (cells_.size() * cell_ * cell_ * cell_ < 0.1)
    throw InputError(
        source + ": no free space to move a camera in was found (closed walls, floor and ceiling, 0.35 m " +
        "from every surface); give a closed room in metres, and its up axis if it was guessed wrong.");
}

/// Surfaces in nearly all of 14 directions, the vertical ones included.
bool FreeSpace::isInside(const Eigen::Vector3d& point) const {
  if (!tracer_.cast(point, up(), kFarWall) || !tracer_.cast(point, -up(), kFarWall)) return false;
  int misses = 0;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1).cast<double>();
    const int axes = static_cast<int>(d.cwiseAbs().sum());
    if (axes != 1 && axes != 3) continue;
    if (!tracer_.cast(point, d, kFarWall) && ++misses > 2) return false;
  }
  return true;
}

std::int64_t FreeSpace::gridIndex(const Eigen::Vector3i& c) const {
  if ((c.array() < 0).any() || (c.array() >= count_.array()).any()) return -1;
  return c.x() + std::int64_t(count_.x()) * (c.y() + std::int64_t(count_.y()) * c.z());
}

std::int64_t FreeSpace::find(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d c = ((point - low_) / cell_).array().floor();
  const std::int64_t i = gridIndex(c.cast<int>());
  return i < 0 ? -1 : index_[i];
}

std::vector<std::int64_t> FreeSpace::neighbours(std::size_t i) const {
  std::vector<std::int64_t> result;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      const std::int64_t n = find(cells_[i] + step * cell_ * Eigen::Vector3d::Unit(axis));
      if (n >= 0) result.push_back(n);
    }
  return result;
}

bool FreeSpace::isSegmentClear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double clearance) const {
  // A ball of radius r about each point proves the segment clear up to r - clearance from it.
  const double length = (b - a).norm();
  const Eigen::Vector3d direction = length > 0 ? Eigen::Vector3d((b - a) / length) : Eigen::Vector3d::Zero();
  for (double s = 0; s <= length;) {
    const double room = tracer_.clearance(a + s * direction, clearance + 1);
    if (room < clearance) return false;
    s += std::max(0.01, room - clearance);
  }
  return isClear(b, clearance);
}

}  // namespace rosefusion
