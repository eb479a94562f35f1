// Fewer triangles for the same surface.
#pragma once
#include <cstddef>

#include "host/core/mesh.h"

namespace rosefusion {

struct DecimationOptions {
  double max_error = 0.005;   ///< metres that the surface may move
  std::size_t triangles = 0;  ///< stop at so many; 0: as few as the error allows
};

/// Joins edges where the surface stays within the error, borders included; normals and colours are those of
/// the vertices that stay. Triangles and vertices are put in an order that draws fast.
TriangleMesh decimated(const TriangleMesh& mesh, const DecimationOptions& options);

}  // namespace rosefusion
