// How far a reconstructed surface is from the true one.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/core/camera.h"
#include "host/core/mesh.h"
#include "host/evaluation/error_summary.h"

namespace rosefusion {

struct MeshErrorOptions {
  std::size_t samples = 200000;  ///< on each surface, uniform by area
  std::uint64_t seed = 1;
  Pose truth_from_reconstruction = Pose::Identity();
  std::vector<double> thresholds_m{0.05, 0.15};
  double inlier_m = 0.15;  ///< the paper's
  /// What messages call the two meshes: their files, if they have some.
  std::string reconstruction_name = "the reconstruction";
  std::string truth_name = "the truth";
};

/// Shares (0 to 1) at one distance.
struct MeshScore {
  double threshold_m = 0;
  double completeness = 0;  ///< of the true surface that lies within the distance of the reconstruction
  double precision = 0;     ///< of the reconstruction that lies within the distance of the truth
  double f_score = 0;       ///< their harmonic mean
};

struct MeshErrors {
  std::size_t reconstruction_samples = 0;
  std::size_t truth_samples = 0;
  /// Distances of the reconstruction's samples to the truth; its RMSE is the paper's accuracy.
  ErrorSummary accuracy_m;
  /// The same over the samples within MeshErrorOptions::inlier_m only: how exact is what is not plainly
  /// wrong.
  ErrorSummary inlier_accuracy_m;
  double inlier_m = 0;
  ErrorSummary truth_to_reconstruction_m;
  std::vector<MeshScore> scores;  ///< one for each of MeshErrorOptions::thresholds_m
};

/// Distances run from random points on one surface to the nearest point *on the triangles* of the other
/// (exact, so that sampling adds no distance of its own). A mesh without triangles is taken as a point cloud:
/// its vertices are the samples and the targets. The truth counts as a whole, whether a camera ever saw it or
/// not.
///
/// Throws InputError, by the name in the options, for a mesh without vertices, with vertices
/// that are not finite, with triangles that name missing vertices, or with no area.
MeshErrors measureMesh(const TriangleMesh& reconstruction, const TriangleMesh& truth,
                       const MeshErrorOptions& options = {});

}  // namespace rosefusion
