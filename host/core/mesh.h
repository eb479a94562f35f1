// A triangle mesh in memory.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rosefusion {

/// Vertices in metres (world frame). normals and colours (RGB) are empty or as long as vertices.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< counter-clockwise seen from the outside (free space)
  /// Where the vertices' zero lies in the file's frame, metres: taken off meshes far from their origin (in
  /// national or UTM coordinates), which floats cannot hold.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

}  // namespace rosefusion
