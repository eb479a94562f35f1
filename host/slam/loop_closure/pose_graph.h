// Poses that agree best with what was measured between them. Pure: no device, no images.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

/// A measured motion between two poses of the graph, and how far it may be off.
struct PoseEdge {
  std::size_t first = 0, second = 0;
  Pose first_from_second = Pose::Identity();
  double shift_deviation = 0.01;  ///< metres
  double turn_deviation = 0.01;   ///< radians
};

/// Least squares over all edges (Ceres), starting from `poses`; the first pose stays where it is. Edges name
/// poses by their index; what no edge joins to the first stays about where it is. The same input gives the
/// same result.
std::vector<Pose> optimisePoses(std::vector<Pose> poses, std::span<const PoseEdge> edges);

/// How far the poses are from an edge's motion, metres.
double residualOf(const PoseEdge& edge, std::span<const Pose> poses);

}  // namespace rosefusion
