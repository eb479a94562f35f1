// PLY files, read without assimp: its 5.2 reader swallows a first data byte that looks like white space.
#pragma once
#include <filesystem>

#include "host/core/mesh.h"

namespace rosefusion {

/// How far 32-bit floats of this size are apart.
double spacingOfFloats(double value);
/// Throws InputError, naming the mesh, where floats as large as `largest` are too far apart to show a mesh of
/// this diagonal, metres.
void requireFineFloats(const std::string& name, double largest, double diagonal);

/// Reads text and binary PLY of either byte order: positions, normals and colours (red green blue) where
/// present, polygons cut into fans, everything else skipped. Throws InputError, naming the file, for one that
/// is cut short or damaged, or whose coordinates were rounded too far. Vertices far from the file's origin
/// get one of their own (TriangleMesh::origin). The mesh may come out empty.
TriangleMesh readPly(const std::filesystem::path& file);

}  // namespace rosefusion
