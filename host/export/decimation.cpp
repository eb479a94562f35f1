#include "host/export/decimation.h"

#include <meshoptimizer.h>

#include <algorithm>

namespace rosefusion {
namespace {

template <typename T>
void remap(std::vector<T>& values, const std::vector<unsigned>& to, std::size_t count) {
  if (values.empty()) return;
  std::vector<T> out(count);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (to[i] != ~0u) out[to[i]] = values[i];
  values = std::move(out);
}

}  // namespace

TriangleMesh decimated(const TriangleMesh& mesh, const DecimationOptions& options) {
  TriangleMesh out = mesh;
  if (mesh.triangles.empty()) return out;
  const auto* indices = reinterpret_cast<const unsigned*>(mesh.triangles.data());
  const std::size_t count = 3 * mesh.triangles.size();
  const float* positions = mesh.vertices.front().data();
  constexpr std::size_t kStride = sizeof(Eigen::Vector3f);
  const float extent = meshopt_simplifyScale(positions, mesh.vertices.size(), kStride);
  std::vector<unsigned> kept(count);
  kept.resize(meshopt_simplify(kept.data(), indices, count, positions, mesh.vertices.size(), kStride,
                               std::min(count, 3 * options.triangles),
                               static_cast<float>(options.max_error) / std::max(extent, 1e-9f), 0, nullptr));
  meshopt_optimizeVertexCache(kept.data(), kept.data(), kept.size(), mesh.vertices.size());
  std::vector<unsigned> to(mesh.vertices.size());
  const std::size_t vertices =
      meshopt_optimizeVertexFetchRemap(to.data(), kept.data(), kept.size(), mesh.vertices.size());
  remap(out.vertices, to, vertices);
  remap(out.normals, to, vertices);
  remap(out.colours, to, vertices);
  out.triangles.resize(kept.size() / 3);
  for (std::size_t i = 0; i < kept.size(); ++i) out.triangles[i / 3][i % 3] = to[kept[i]];
  return out;
}

}  // namespace rosefusion
