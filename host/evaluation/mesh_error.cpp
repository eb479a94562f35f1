#include "host/evaluation/mesh_error.h"

#include <algorithm>
#include <string>

#include "host/core/error.h"
#include "host/evaluation/surface_distance.h"
#include "host/evaluation/surface_sampling.h"

namespace rosefusion {
namespace {

void requireSound(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.vertices.empty())
    throw InputError(name + ": the mesh has no vertices; there is nothing to measure.");
  for (const Eigen::Vector3f& v : mesh.vertices)
    if (!v.allFinite())
      throw InputError(name + ": the mesh has a vertex that is not finite; clean it with a mesh editor.");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      if (index >= mesh.vertices.size())
        throw InputError(name + ": a triangle names vertex " + std::to_string(index) + " of " +
                         std::to_string(mesh.vertices.size()) + "; the mesh is damaged, write it anew.");
}

std::vector<Eigen::Vector3d> samples(const TriangleMesh& mesh, const MeshErrorOptions& options,
                                     std::uint64_t stream, const std::string& name) {
  // Two streams of one seed: equal meshes must not be sampled at the same points.
  std::vector<Eigen::Vector3d> points = sampleSurface(mesh, options.samples, 2 * options.seed + stream);
  if (points.empty())
    throw InputError(name +
                     ": the mesh's triangles have no area, so that no points can be drawn on it; check its "
                     "unit, which must be metres.");
  return points;
}

std::vector<double> distances(const TriangleMesh& to, std::vector<Eigen::Vector3d> from,
                              const Pose& to_from_from) {
  for (Eigen::Vector3d& p : from) p = to_from_from * p;
  return SurfaceDistance(to).to(from);
}

double shareWithin(const std::vector<double>& distances_m, double limit_m) {
  const auto within =
      std::count_if(distances_m.begin(), distances_m.end(), [&](double d) { return d <= limit_m; });
  return static_cast<double>(within) / static_cast<double>(distances_m.size());
}

}  // namespace

MeshErrors measureMesh(const TriangleMesh& reconstruction, const TriangleMesh& truth,
                       const MeshErrorOptions& options) {
  requireSound(reconstruction, options.reconstruction_name);
  requireSound(truth, options.truth_name);
  const auto reconstruction_points = samples(reconstruction, options, 0, options.reconstruction_name);
  const auto truth_points = samples(truth, options, 1, options.truth_name);
  // Between the meshes' own origins, so that large coordinates cancel before floats see them.
  Pose truth_from_reconstruction = options.truth_from_reconstruction;
  truth_from_reconstruction.translation() =
      options.truth_from_reconstruction * reconstruction.origin - truth.origin;
  const std::vector<double> to_truth = distances(truth, reconstruction_points, truth_from_reconstruction);
  const std::vector<double> to_reconstruction =
      distances(reconstruction, truth_points, truth_from_reconstruction.inverse());

  MeshErrors errors;
  errors.reconstruction_samples = to_truth.size();
  errors.truth_samples = to_reconstruction.size();
  errors.accuracy_m = summarise(to_truth);
  errors.truth_to_reconstruction_m = summarise(to_reconstruction);
  errors.inlier_m = options.inlier_m;
  std::vector<double> inliers = to_truth;
  std::erase_if(inliers, [&](double d) { return d > options.inlier_m; });
  errors.inlier_accuracy_m = summarise(inliers);
  for (const double limit_m : options.thresholds_m) {
    MeshScore score{limit_m, shareWithin(to_reconstruction, limit_m), shareWithin(to_truth, limit_m)};
    const double sum = score.completeness + score.precision;
    score.f_score = sum > 0 ? 2 * score.completeness * score.precision / sum : 0;
    errors.scores.push_back(score);
  }
  return errors;
}

}  // namespace rosefusion
