// Random points on a surface.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/mesh.h"

namespace rosefusion {

/// `count` points on the mesh's triangles, uniform by area, the same for the same seed on every platform.
/// Without triangles: the vertices themselves, or `count` of them drawn at random (with repeats) when there
/// are more. Empty for a mesh whose triangles have no area.
std::vector<Eigen::Vector3d> sampleSurface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace rosefusion
