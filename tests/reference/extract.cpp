#include "tests/reference/extract.h"

#include <algorithm>
#include <vector>

namespace rosefusion::reference {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

class Extraction {
 public:
  Extraction(const Field& field, double min_weight) : field_(field), min_weight_(min_weight) {}

  Surface run() {
    const Vector3i end = field_.low() + field_.size();
    for (int z = field_.low().z(); z < end.z(); ++z)
      for (int y = field_.low().y(); y < end.y(); ++y)
        for (int x = field_.low().x(); x < end.x(); ++x)
          if (complete({x, y, z})) addCell({x, y, z});
    return std::move(surface_);
  }

 private:
  bool observed(const Vector3i& v) const { return field_.weight(v) > 0 && field_.weight(v) >= min_weight_; }
  bool inside(const Vector3i& v) const { return field_.tsdf(v) < 0; }

  bool complete(const Vector3i& cell) const {
    int inside_corners = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3i v = cell + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
      if (!observed(v)) return false;
      inside_corners += inside(v);
    }
    return inside_corners > 0 && inside_corners < 8;
  }

  void addCell(const Vector3i& cell) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        addFace(cell + side * Vector3i::Unit(axis), Vector3i::Unit((axis + 1) % 3),
                Vector3i::Unit((axis + 2) % 3));
  }

  void addFace(const Vector3i& corner, const Vector3i& a, const Vector3i& b) {
    const std::array<Vector3i, 4> around = {corner, corner + a, corner + a + b, corner + b};
    std::vector<GridEdge> crossings;
    for (int i = 0; i < 4; ++i)
      if (inside(around[i]) != inside(around[(i + 1) % 4]))
        crossings.push_back(edgeBetween(around[i], around[(i + 1) % 4]));
    for (const GridEdge& edge : crossings) addPoint(edge);
    if (crossings.size() == 2) addSegment(crossings[0], crossings[1]);
    if (crossings.size() == 4)
      for (int i = 0; i < 4; ++i)
        if (inside(around[i]))
          addSegment(edgeBetween(around[i], around[(i + 3) % 4]),
                     edgeBetween(around[i], around[(i + 1) % 4]));
  }

  static GridEdge edgeBetween(const Vector3i& a, const Vector3i& b) {
    int axis = 0;
    while (a[axis] == b[axis]) ++axis;
    const Vector3i& first = a[axis] < b[axis] ? a : b;
    return {first.x(), first.y(), first.z(), axis};
  }

  void addSegment(const GridEdge& a, const GridEdge& b) {
    ++surface_.segments[{std::min(a, b), std::max(a, b)}];
  }

  void addPoint(const GridEdge& edge) {
    if (surface_.points.contains(edge)) return;
    const Vector3i from(edge[0], edge[1], edge[2]), to = from + Vector3i::Unit(edge[3]);
    const double a = field_.tsdf(from), b = field_.tsdf(to);
    const double share = std::clamp(a / (a - b), 0.001, 0.999);
    const Vector3d position =
        ((1 - share) * from.cast<double>() + share * to.cast<double>() + Vector3d::Constant(0.5));
    const Vector3d normal = (1 - share) * gradient(from) + share * gradient(to);
    surface_.points[edge] = {position * field_.voxelSize(), normal.normalized()};
  }

  Vector3d gradient(const Vector3i& v) const {
    Vector3d out;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3i before = v - Vector3i::Unit(axis), after = v + Vector3i::Unit(axis);
      const Vector3i& low = observed(before) ? before : v;
      const Vector3i& high = observed(after) ? after : v;
      const int steps = high[axis] - low[axis];
      out[axis] = steps > 0 ? (field_.tsdf(high) - field_.tsdf(low)) / steps : 0;
    }
    return out;
  }

  const Field& field_;
  double min_weight_;
  Surface surface_;
};

}  // namespace

Surface extractSurface(const Field& field, double min_weight) {
  return Extraction(field, min_weight).run();
}

}  // namespace rosefusion::reference
