// The volume's surface as one welded triangle mesh.
#pragma once
#include <cstddef>

#include "engine/passes/extract.h"
#include "host/core/mesh.h"

namespace rosefusion {

struct MeshOptions {
  float min_weight = 1;                     ///< observations below which a voxel counts as unobserved
  std::size_t min_component_triangles = 0;  ///< smaller connected parts, which are mostly noise, are dropped
};

/// World frame, metres, with normals; with colours when the volume has them (surface without a colour turns
/// grey). Every vertex serves a triangle, and triangles that meet share their vertices, across blocks too.
/// The same volume gives the same mesh, byte for byte. Empty when nothing was observed. Throws DeviceError.
TriangleMesh extractMesh(ExtractPass& pass, const Volume& volume, const MeshOptions& options = {});

/// Drops connected parts (triangles joined by vertices) of fewer than `min_triangles`; order is kept.
void dropSmallComponents(TriangleMesh& mesh, std::size_t min_triangles);

/// Drops vertices that no triangle uses; order is kept.
void dropUnusedVertices(TriangleMesh& mesh);

}  // namespace rosefusion
