// Reference of mesh extraction: where the surface crosses the voxel grid's edges and the cells' faces. What
// happens inside a cell is left open, so that no table of cases is needed.
#pragma once
#include <array>
#include <map>
#include <utility>

#include "tests/reference/raycast_field.h"

namespace rosefusion::reference {

/// Voxel and axis: the edge from the voxel's centre to the next one's.
using GridEdge = std::array<int, 4>;
using Segment = std::pair<GridEdge, GridEdge>;  ///< the smaller one first

struct SurfacePoint {
  Eigen::Vector3d position;  ///< metres
  Eigen::Vector3d normal;    ///< unit length, towards free space
};

struct Surface {
  std::map<GridEdge, SurfacePoint> points;
  std::map<Segment, int>
      segments;  ///< on cell faces, with the number of cells (1 or 2) whose surface they bound
};

/// Cells count when all their corners were observed at least `min_weight` times. On a face with two inside
/// (negative) corners across, each is cut off by itself.
Surface extractSurface(const Field& field, double min_weight);

}  // namespace rosefusion::reference
