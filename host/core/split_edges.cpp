#include "host/core/split_edges.h"

#include <algorithm>
#include <map>
#include <utility>

namespace rosefusion {

void splitLongEdges(TriangleMesh& mesh, float longest) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] =
        midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) / 2);
      if (!mesh.normals.empty()) mesh.normals.push_back((mesh.normals[a] + mesh.normals[b]).normalized());
      if (!mesh.colours.empty()) {
        auto colour = mesh.colours[a];
        for (int i = 0; i < 3; ++i)
          colour[i] = static_cast<std::uint8_t>((colour[i] + mesh.colours[b][i]) / 2);
        mesh.colours.push_back(colour);
      }
    }
    return entry->second;
  };
  for (std::size_t i = 0; i < mesh.triangles.size();) {
    const auto t = mesh.triangles[i];
    int edge = 0;
    float length = 0;
    for (int e = 0; e < 3; ++e) {
      const float l = (mesh.vertices[t[e]] - mesh.vertices[t[(e + 1) % 3]]).norm();
      if (l > length) length = l, edge = e;
    }
    if (length <= longest) {
      ++i;
      continue;
    }
    const std::uint32_t a = t[edge], b = t[(edge + 1) % 3], c = t[(edge + 2) % 3], m = middle(a, b);
    mesh.triangles[i] = {a, m, c};
    mesh.triangles.push_back({m, b, c});
  }
}

}  // namespace rosefusion
