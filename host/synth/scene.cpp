// Procedural materials, and scenes from a user's mesh.
#include "host/synth/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/split_edges.h"
#include "host/export/mesh_io.h"

namespace rosefusion {
namespace {

float latticeValue(int x, int y, int z) {
  std::uint32_t h = 2166136261u;
  for (const int v : {x, y, z}) h = (h ^ static_cast<std::uint32_t>(v)) * 16777619u ^ (h >> 13);
  h = (h ^ (h >> 15)) * 0x85EBCA6Bu;
  return static_cast<float>((h ^ (h >> 13)) & 0xFFFFu) / 65535.0f;
}

/// Smooth noise in [0, 1] with unit cells: lattice values, trilinearly blended.
float valueNoise(const Eigen::Vector3d& p) {
  const Eigen::Vector3d floor = p.array().floor();
  const Eigen::Vector3i cell = floor.cast<int>();
  const Eigen::Vector3f f = (p - floor).cast<float>();
  const Eigen::Vector3f s = f.array() * f.array() * (3 - 2 * f.array());
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
    const float weight = (dx ? s.x() : 1 - s.x()) * (dy ? s.y() : 1 - s.y()) * (dz ? s.z() : 1 - s.z());
    sum += weight * latticeValue(cell.x() + dx, cell.y() + dy, cell.z() + dz);
  }
  return sum;
}

/// Brightness factor of the pattern; cells are shifted by a little so that a surface at a cell boundary (a
/// floor at z = 0) does not flicker between two cells.
float patternValue(const Material& material, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = point / material.scale + Eigen::Vector3d(0.37, 0.41, 0.43);
  const auto odd = [](double v) { return std::lround(std::floor(v)) & 1; };
  switch (material.pattern) {
    case Pattern::Plain:
      return 1;
    case Pattern::Checker:
      return ((odd(p.x()) + odd(p.y()) + odd(p.z())) & 1 ? 0.7f : 1.0f) - 0.15f * valueNoise(p * 5);
    case Pattern::Stripes:
      return (odd(p.x() + p.y() + p.z()) ? 0.65f : 1.0f) - 0.15f * valueNoise(p * 5);
    case Pattern::Wood:
      return 0.7f + 0.3f * valueNoise({p.x() * 0.15, p.y(), p.z()}) -
             0.15f * valueNoise({p.x() * 0.5, p.y() * 6, p.z() * 6});
    case Pattern::Noise:
      break;
  }
  return 0.75f + 0.25f * valueNoise(p) - 0.15f * valueNoise(p * 4.1);
}

constexpr float kLongestEdge = 0.3f;

/// The pieces of all triangles must fit into memory: some 100 bytes each.
void requireSplittable(const TriangleMesh& mesh, const std::string& name) {
  constexpr double kMostPieces = 2e7;
  double area = 0;
  for (const auto& t : mesh.triangles)
    area += (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                .cast<double>()
                .cross((mesh.vertices[t[2]] - mesh.vertices[t[0]]).cast<double>())
                .norm() /
            2;
  if (area / (0.5 * kLongestEdge * kLongestEdge) > kMostPieces)
    throw InputError(
        printed("%s: the mesh has %.3g m2 of surface, more than can be rendered; cut out the rooms to fly "
                "through, or simplify it.",
                name.c_str(), area));
}

/// The axis that floors and ceilings are perpendicular to: y or z, whichever has more area facing along it.
Eigen::Vector3d guessUp(const TriangleMesh& mesh) {
  double area_y = 0, area_z = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f n =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    const float length = n.norm();
    if (std::abs(n.y()) > 0.95f * length) area_y += length;
    if (std::abs(n.z()) > 0.95f * length) area_z += length;
  }
  return area_y > area_z ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
}

}  // namespace

Eigen::Vector3f materialColour(const Material& material, const Eigen::Vector3d& point) {
  const Eigen::Vector3f rgb(material.rgb[0], material.rgb[1], material.rgb[2]);
  return (rgb / 255 * patternValue(material, point)).cwiseMin(1).cwiseMax(0);
}

void paintVertices(Scene& scene) {
  scene.mesh.colours.assign(scene.mesh.vertices.size(), {128, 128, 128});
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i)
    for (const std::uint32_t v : scene.mesh.triangles[i]) {
      const Eigen::Vector3f c = 255 * materialColour(scene.materials[scene.face_material[i]],
                                                     scene.mesh.vertices[v].cast<double>());
      for (int k = 0; k < 3; ++k) scene.mesh.colours[v][k] = static_cast<std::uint8_t>(c[k]);
    }
}

Scene loadScene(const std::filesystem::path& file, UpAxis up) {
  Scene scene;
  scene.mesh = readMesh(file);
  scene.origin = std::exchange(scene.mesh.origin, Eigen::Vector3d::Zero());
  Eigen::Vector3f low = scene.mesh.vertices[0], high = low;
  for (const Eigen::Vector3f& v : scene.mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  const Eigen::Vector3f size = high - low;
  if (size.minCoeff() < 1 || size.maxCoeff() > 200) {
    const auto metres = [](float v) { return printed("%.3g", static_cast<double>(v)); };
    throw InputError(file.string() + ": the mesh measures " + metres(size.x()) + " x " + metres(size.y()) +
                     " x " + metres(size.z()) + " m, which is no room or building; scale it to metres.");
  }
  requireSplittable(scene.mesh, file.string());
  splitLongEdges(scene.mesh, kLongestEdge);
  scene.up = up == UpAxis::Y   ? Eigen::Vector3d(Eigen::Vector3d::UnitY())
             : up == UpAxis::Z ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                               : guessUp(scene.mesh);
  if (scene.mesh.colours.empty()) {
    scene.materials = {{{190, 180, 165}, Pattern::Noise, 0.15f}};
    scene.face_material.assign(scene.mesh.triangles.size(), 0);
    paintVertices(scene);
  }
  return scene;
}

}  // namespace rosefusion
