// Mesh files in and out.
#pragma once
#include <filesystem>

#include "host/core/mesh.h"

namespace rosefusion {

/// Reads PLY and whatever assimp knows (OBJ, STL, glTF ...), all parts joined, equal vertices welded, in the
/// file's own axes and units (taken as metres); one far from its origin gets one of its own
/// (TriangleMesh::origin). Throws InputError for a missing, unreadable or empty file, and for coordinates
/// that floats round too far. `allow_points`: a PLY without faces is read as a point cloud, a mesh without
/// triangles.
TriangleMesh readMesh(const std::filesystem::path& file, bool allow_points = false);

/// Writes binary little-endian PLY with float positions (double ones where it has an origin of its own),
/// normals and uchar colours where present. The file appears whole or not at all; throws InputError naming
/// it.
void writePly(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace rosefusion
