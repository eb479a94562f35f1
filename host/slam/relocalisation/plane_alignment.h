// Where a camera must stand for the surfaces in its image to lie on those of a model: without a guess, from
// the offsets of planes.
#pragma once
#include <span>
#include <vector>

#include "host/core/trajectory.h"
#include "host/slam/mapping/surface_patches.h"

namespace rosefusion {

/// A start for the refinement, by planes alone: whether the depth fits is not asked yet.
struct PoseHypothesis {
  Pose world_from_camera = Pose::Identity();
  double met = 0;  ///< share of the view's patches that lie on the model's
};

/// Poses with one of these rotations that put many of the view's patches onto the model's, at most `most`,
/// the one that puts most there first; no two are near each other. `view`: in the camera's frame, `model`: in
/// the world's.
///
/// Along each of up to three directions that surfaces of the view face, the offsets of its patches are
/// correlated with those of the model's; combinations of the best shifts are tried on the patches
/// themselves. Where the view has only two such directions, the third is tried all along the model.
std::vector<PoseHypothesis> poseHypotheses(std::span<const SurfacePatch> view,
                                           std::span<const SurfacePatch> model,
                                           std::span<const Eigen::Matrix3d> rotations, std::size_t most);

}  // namespace rosefusion
