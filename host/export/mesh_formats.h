// Meshes for other programs: glTF (.glb) and Wavefront (.obj).
#pragma once
#include <filesystem>
#include <string>

#include "host/core/mesh.h"
#include "host/export/texture/texturing.h"

namespace rosefusion {

/// Whether its vertices differ in colour: a mesh of a recording without colour is grey all over.
bool hasColours(const TriangleMesh& mesh);

/// Binary glTF 2.0, metres: colours as they were seen (KHR_materials_unlit), in linear numbers as the format
/// asks; where it has none a grey surface in whatever light there is.
std::string glbOf(const TriangleMesh& mesh);

/// With colours behind the positions, as MeshLab, Blender and CloudCompare read them.
std::string objOf(const TriangleMesh& mesh);

/// With the texture inside, as JPEG, not lit either: light is in the images already.
std::string glbOf(const TexturedMesh& textured);

/// NAME.obj, and before it, so that it finds them, NAME.mtl and NAME_texture.jpg (with _ for spaces, which
/// some programs take for the end of a name). Throws InputError where they cannot be written.
void writeTexturedObj(const std::filesystem::path& file, const TexturedMesh& textured);

/// By the file's ending: .glb, .obj or .ply. Throws InputError for another, for an empty mesh, and where it
/// cannot be written.
void writeMesh(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace rosefusion
