#include "host/slam/mapping/mesh_extraction.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "engine/error.h"

namespace rosefusion {
namespace {

using namespace shader;

constexpr std::array<std::uint8_t, 3> kNoColour = {204, 199, 189};  // the raycast preview's clay

/// Which vertex lies on which edge: a block's edges stand together and ascend.
struct EdgeIndex {
  std::vector<std::uint32_t> first;  ///< by slot, one more at the end: the block's first vertex
  std::vector<std::uint16_t> edges;  ///< by vertex: the edge within its block

  std::uint32_t vertexOf(std::uint32_t edge) const {
    const std::uint32_t slot = edge / kBlockEdges, within = edge % kBlockEdges;
    const auto begin = edges.begin() + first[slot], end = edges.begin() + first[slot + 1];
    const auto found = std::lower_bound(begin, end, within);
    if (found == end || *found != within)
      throw DeviceError(DeviceErrorCode::Programming,
                        "The extracted surface names a vertex that was not extracted.");
    return static_cast<std::uint32_t>(found - edges.begin());
  }
};

void append(const ExtractBatch& batch, bool colour, TriangleMesh& mesh, EdgeIndex& index) {
  for (const ExtractBlock& block : batch.blocks)
    // Slots passed over since the last block have no vertices: they begin and end where this one begins.
    while (index.first.size() <= block.slot)
      index.first.push_back(static_cast<std::uint32_t>(mesh.vertices.size()) + block.first_vertex);
  for (const ExtractVertex& v : batch.vertices) {
    index.edges.push_back(static_cast<std::uint16_t>(v.edge));
    mesh.vertices.emplace_back(v.x, v.y, v.z);
    mesh.normals.emplace_back(v.normal_x, v.normal_y, v.normal_z);
    if (!colour) continue;
    const std::uint32_t c = v.colour;
    mesh.colours.push_back(c >> 24 ? std::array{std::uint8_t(c), std::uint8_t(c >> 8), std::uint8_t(c >> 16)}
                                   : kNoColour);
  }
  for (std::size_t i = 0; i < batch.triangles.size(); i += 3)
    mesh.triangles.push_back({batch.triangles[i], batch.triangles[i + 1], batch.triangles[i + 2]});
}

/// Representative of every vertex's connected part.
std::vector<std::uint32_t> connectedParts(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles) {
    const std::uint32_t a = root(t[0]);
    parent[root(t[1])] = a;
    parent[root(t[2])] = a;
  }
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

template <typename T>
void keepOnly(std::vector<T>& items, const std::vector<bool>& kept) {
  if (items.empty()) return;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) items[count++] = items[i];
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(count), items.end());
}

}  // namespace

void dropSmallComponents(TriangleMesh& mesh, std::size_t min_triangles) {
  const auto part = connectedParts(mesh);
  std::vector<std::size_t> triangles(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) ++triangles[part[t[0]]];
  std::erase_if(mesh.triangles, [&](const auto& t) { return triangles[part[t[0]]] < min_triangles; });
  dropUnusedVertices(mesh);
}

void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  std::vector<std::uint32_t> renamed(mesh.vertices.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < used.size(); ++v) renamed[v] = used[v] ? count++ : 0;
  keepOnly(mesh.vertices, used);
  keepOnly(mesh.normals, used);
  keepOnly(mesh.colours, used);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = renamed[v];
}

TriangleMesh extractMesh(ExtractPass& pass, const Volume& volume, const MeshOptions& options) {
  TriangleMesh mesh;
  EdgeIndex index;
  pass.run(volume, options.min_weight,
           [&](const ExtractBatch& batch) { append(batch, volume.options().colour, mesh, index); });
  if (mesh.vertices.size() > std::numeric_limits<std::uint32_t>::max())
    throw DeviceError(DeviceErrorCode::OutOfMemory,
                      "The mesh has too many vertices; make volume.voxel_size larger.");
  index.first.resize(volume.blocks().size() + 1, static_cast<std::uint32_t>(mesh.vertices.size()));
  for (auto& t : mesh.triangles)
    for (std::uint32_t& corner : t) corner = index.vertexOf(corner);
  if (options.min_component_triangles > 1)
    dropSmallComponents(mesh, options.min_component_triangles);
  else
    dropUnusedVertices(mesh);
  return mesh;
}

}  // namespace rosefusion
