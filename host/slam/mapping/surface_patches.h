// Which way the surfaces of a scene face, and how a camera must be turned for its image to agree.
#pragma once
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

/// A direction that many surfaces face, such as a floor's or a wall's.
struct SurfaceDirection {
  Eigen::Vector3d normal;  ///< unit length, off the surface
  double share = 0;        ///< of the normals that lie around it
};

/// A flat piece of a surface.
struct SurfacePatch {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< unit length, towards the camera
};

/// Patches, in the camera's frame, of places spread evenly over a depth image (CV_32F metres, 0 where
/// invalid) that are flat over a twentieth of its width.
std::vector<SurfacePatch> surfacePatches(const cv::Mat& depth, const Intrinsics& camera);
std::vector<Eigen::Vector3d> normalsOf(std::span<const SurfacePatch> patches);

/// Those that at least `least_share` of the normals lie around, at most `most`, the commonest first.
std::vector<SurfaceDirection> dominantDirections(std::span<const Eigen::Vector3d> normals, double least_share,
                                                 std::size_t most);

/// Rotations from the view's frame to the model's that take two of the view's directions to two of the
/// model's, at most `most`, the one that explains most of the view first. None where the view has but one
/// direction.
std::vector<Eigen::Matrix3d> rotationHypotheses(std::span<const SurfaceDirection> view,
                                                std::span<const SurfaceDirection> model, std::size_t most);

}  // namespace rosefusion
