#include "host/swarm/poisson_ball.h"

#include <cmath>
#include <cstdint>

namespace rosefusion {
namespace {

constexpr int kDimensions = 6;

double squaredDistance(const Point6& a, const Point6& b) {
  double sum = 0;
  for (int d = 0; d < kDimensions; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

// Background grid whose cells are as wide as the radius. Bridson's cells of radius / sqrt(6), one point each,
// would mean 5^6 = 15625 look-ups a candidate; here 255 cells touch the disk on average (Steiner's formula)
// and hold about two points each, and the nearest are visited first because most candidates are rejected.
class Grid {
 public:
  explicit Grid(double radius) : radius_(radius) {
    per_axis_ = std::clamp(static_cast<int>(std::floor(2 / radius)), 1, kMostCellsPerAxis);
    width_ = 2.0 / per_axis_;
    size_t cells = 1;
    for (int d = 0; d < kDimensions; ++d) cells *= static_cast<size_t>(per_axis_);
    first_.assign(cells, kNone);
  }

  void insert(const Point6& point) {
    size_t cell = 0;
    for (int d = 0; d < kDimensions; ++d)
      cell = cell * static_cast<size_t>(per_axis_) + static_cast<size_t>(axisCell(point[d]));
    next_.push_back(first_[cell]);
    first_[cell] = static_cast<int32_t>(points_.size());
    points_.push_back(point);
  }

  bool isFree(const Point6& candidate) const { return isFree(candidate, 0, 0, radius_ * radius_); }

  std::vector<Point6>& points() { return points_; }

 private:
  static constexpr int32_t kNone = -1;
  static constexpr int kMostCellsPerAxis = 12;  // 12^6 cells are 12 MB

  int axisCell(double x) const { return std::clamp(static_cast<int>((x + 1) / width_), 0, per_axis_ - 1); }

  // Descends one axis at a time; `budget` is what the axes so far leave of the squared radius.
  bool isFree(const Point6& candidate, int axis, size_t cell, double budget) const {
    if (axis == kDimensions) {
      for (int32_t i = first_[cell]; i != kNone; i = next_[static_cast<size_t>(i)])
        if (squaredDistance(points_[static_cast<size_t>(i)], candidate) < radius_ * radius_) return false;
      return true;
    }
    const int home = axisCell(candidate[axis]);
    const double below = candidate[axis] + 1 - home * width_;
    const double above = width_ - below;
    const auto descend = [&](int index, double gap) {
      return index < 0 || index >= per_axis_ || gap * gap >= budget ||
             isFree(candidate, axis + 1, cell * static_cast<size_t>(per_axis_) + static_cast<size_t>(index),
                    budget - gap * gap);
    };
    if (!descend(home, 0)) return false;
    if (below < above) return descend(home - 1, below) && descend(home + 1, above);
    return descend(home + 1, above) && descend(home - 1, below);
  }

  double radius_;
  double width_;
  int per_axis_;
  std::vector<int32_t> first_;  // per cell
  std::vector<int32_t> next_;   // per point
  std::vector<Point6> points_;
};

}  // namespace

std::vector<Point6> poissonBall(double radius, int candidates, PortableRandom& random) {
  Grid grid(radius);
  grid.insert(Point6{});
  std::vector<uint32_t> active = {0};
  while (!active.empty()) {
    const uint32_t slot = random.below(static_cast<uint32_t>(active.size()));
    const Point6 parent = grid.points()[active[slot]];
    bool found = false;
    for (int attempt = 0; attempt < candidates && !found; ++attempt) {
      double distance;  // uniform by volume in the shell from radius to 2 radius
      do distance = 2 * radius * random.ballRadius();
      while (distance < radius);
      Point6 candidate = random.direction();
      double norm = 0;
      for (int d = 0; d < kDimensions; ++d) {
        candidate[d] = parent[d] + distance * candidate[d];
        norm += candidate[d] * candidate[d];
      }
      if (norm > 1 || !grid.isFree(candidate)) continue;
      active.push_back(static_cast<uint32_t>(grid.points().size()));
      grid.insert(candidate);
      found = true;
    }
    if (!found) {
      active[slot] = active.back();
      active.pop_back();
    }
  }
  return std::move(grid.points());
}

}  // namespace rosefusion
