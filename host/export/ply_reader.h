// PLY files, read without assimp: its 5.2 reader swallows a first data byte that looks like white space.
#pragma once
#include <filesystem>

#include "host/core/mesh.h"

namespace rosefusion {

/// Reads text and binary PLY of either byte order: positions, normals and colours (red green blue) where
/// present, polygons cut into fans, everything else skipped. Throws InputError, naming the file, for one that
/// is cut short or damaged. The mesh may come out empty.
TriangleMesh readPly(const std::filesystem::path& file);

}  // namespace rosefusion
