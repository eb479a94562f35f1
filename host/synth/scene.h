// What the generator renders: a surface, its materials, and which way is up.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "host/core/mesh.h"

namespace rosefusion {

enum class Pattern { Plain, Checker, Stripes, Noise, Wood };

struct Material {
  std::array<std::uint8_t, 3> rgb{180, 180, 180};
  Pattern pattern = Pattern::Noise;
  float scale = 0.1f;  ///< size of one pattern cell, metres
};

/// What a scene is about: a camera goes around it.
struct Subject {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();      ///< half its size
  std::uint32_t first_triangle = 0, end_triangle = 0;  ///< of it alone; none where it cannot be cut out
};

struct Scene {
  TriangleMesh mesh;  ///< metres, world frame; colours are the materials' at the vertices
  std::vector<std::uint16_t>
      face_material;  ///< one per triangle; empty: the surface has mesh.colours instead
  std::vector<Material> materials;
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();  ///< of a user's mesh: where the world's zero lies in its file
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< unit, along an axis
  Subject subject;                                ///< of makeDesk and makeObject
};

enum class UpAxis { Guess, Y, Z };

/// Surface colour (RGB, 0 to 1) of `material` at a world point, before shading. Procedural, the same at every
/// call.
Eigen::Vector3f materialColour(const Material& material, const Eigen::Vector3d& point);

/// Sets mesh.colours from the materials.
void paintVertices(Scene& scene);

/// A seeded, furnished room, z up, floor at z = 0, 4-7 x 3.5-6 x 2.5-3 m. Each seed differs in size,
/// furniture, layout.
Scene makeRoom(std::uint64_t seed);

/// A seeded desk at a wall: a table top of 1.3 to 1.7 m with a screen and 7 to 14 other things, z up.
Scene makeDesk(std::uint64_t seed);

/// A seeded thing of 0.2 to 0.6 m on a round plate in the middle of a room, z up.
Scene makeObject(std::uint64_t seed);

/// A user's mesh. Long edges are split so that no triangle is larger than about 0.3 m. Throws InputError like
/// readMesh, and for a mesh that is not room-sized (its smallest side under 1 m or its largest over 200 m) or
/// has too much surface to be split so finely.
Scene loadScene(const std::filesystem::path& file, UpAxis up);

}  // namespace rosefusion
