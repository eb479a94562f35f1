// Mesh files, through assimp.
#pragma once
#include <filesystem>

#include "host/mesh.h"

namespace rosefusion {

/// Reads any triangle mesh assimp knows (PLY, OBJ, STL, glTF ...), all its parts joined, identical vertices welded,
/// in the file's own axes and units (taken as metres). Throws InputError for a missing, unreadable or empty file.
TriangleMesh readMesh(const std::filesystem::path& file);

/// Writes binary little-endian PLY with float positions, normals and uchar colours where present. The file appears
/// whole or not at all; throws InputError naming it.
void writePly(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace rosefusion
