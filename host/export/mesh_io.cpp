// Mesh files. PLY is read and written here, because assimp 5.2 (Debian 12) swallows bytes of some binary
// files and writes binary colours as floats under a header that says uchar; assimp reads every other format.
#include "host/export/mesh_io.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <unordered_map>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/export/ply_reader.h"

namespace rosefusion {
namespace {

std::uint8_t toByte(float channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0f, 1.0f) * 255));
}

void append(const aiMesh& part, bool with_normals, bool with_colours, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
    if (with_normals) mesh.normals.emplace_back(part.mNormals[i].x, part.mNormals[i].y, part.mNormals[i].z);
    if (with_colours) {
      const aiColor4D& c = part.mColors[0][i];
      mesh.colours.push_back({toByte(c.r), toByte(c.g), toByte(c.b)});
    }
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

void requireValidIndices(const std::filesystem::path& file, const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (!std::all_of(face.mIndices, face.mIndices + face.mNumIndices,
                       [&](unsigned index) { return index < part.mNumVertices; }))
        throw InputError(file.string() +
                         ": the mesh is damaged (a face names a vertex that is not there); "
                         "export or download it again.");
    }
  }
}

std::string plyHeader(const TriangleMesh& mesh) {
  const std::string type = mesh.origin.isZero() ? "float" : "double";
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.vertices.size()) + "\nproperty " + type + " x\nproperty " + type +
                     " y\nproperty " + type + " z\n";
  if (!mesh.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.colours.empty()) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

void requireConsistent(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const std::size_t count = mesh.vertices.size();
  const bool good = count > 0 && !mesh.triangles.empty() &&
                    (mesh.normals.empty() || mesh.normals.size() == count) &&
                    (mesh.colours.empty() || mesh.colours.size() == count) &&
                    std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                                [&](const auto& t) { return t[0] < count && t[1] < count && t[2] < count; });
  if (!good)
    throw InputError(file.string() +
                     ": not written, because the mesh has no triangles or its parts disagree in length; "
                     "reconstruct or load a surface first.");
}

bool isPly(const std::filesystem::path& file) {
  char magic[4] = {};
  std::ifstream(file, std::ios::binary).read(magic, 4);
  return std::memcmp(magic, "ply\n", 4) == 0 || std::memcmp(magic, "ply\r", 4) == 0;
}

TriangleMesh readWithAssimp(const std::filesystem::path& file) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  // assimp's own steps follow indices without looking, so that a damaged file must be caught before them.
  if (scene) {
    requireValidIndices(file, *scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                         aiProcess_SortByPType);
  }
  TriangleMesh mesh;
  if (scene) {
    bool with_normals = true, with_colours = true;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
      with_normals = with_normals && scene->mMeshes[i]->HasNormals();
      with_colours = with_colours && scene->mMeshes[i]->HasVertexColors(0);
    }
    for (unsigned i = 0; i < scene->mNumMeshes; ++i)
      append(*scene->mMeshes[i], with_normals, with_colours, mesh);
  }
  const std::string reason = importer.GetErrorString();
  if (!scene && reason.find("no meshes") == std::string::npos && !reason.empty())
    throw InputError(file.string() + ": not a readable mesh (" + reason +
                     "); convert it to PLY, OBJ, STL or glTF.");
  return mesh;
}

/// Makes vertices that are equal in everything one, in the order of their first use; drops those no triangle
/// uses.
void weld(TriangleMesh& mesh) {
  using Key = std::array<std::uint32_t, 7>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 14695981039346656037ull;
      for (const std::uint32_t word : key) h = (h ^ word) * 1099511628211ull;
      return h ^ (h >> 29);
    }
  };
  std::unordered_map<Key, std::uint32_t, Hash> known;
  TriangleMesh welded;
  welded.origin = mesh.origin;
  for (auto triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) {
      Key key{};
      const Eigen::Vector3f position = mesh.vertices[v].array() + 0.0f;  // -0 is 0
      std::memcpy(key.data(), position.data(), 12);
      if (!mesh.normals.empty()) std::memcpy(key.data() + 3, mesh.normals[v].data(), 12);
      if (!mesh.colours.empty()) std::memcpy(key.data() + 6, mesh.colours[v].data(), 3);
      const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(welded.vertices.size()));
      if (is_new) {
        welded.vertices.push_back(mesh.vertices[v]);
        if (!mesh.normals.empty()) welded.normals.push_back(mesh.normals[v]);
        if (!mesh.colours.empty()) welded.colours.push_back(mesh.colours[v]);
      }
      v = entry->second;
    }
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      welded.triangles.push_back(triangle);
  }
  mesh = std::move(welded);
}

}  // namespace

TriangleMesh readMesh(const std::filesystem::path& file, bool allow_points) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file.string() + ": no such mesh file; give a PLY, OBJ, STL or glTF file.");
  const bool is_ply = isPly(file);
  TriangleMesh mesh = is_ply ? readPly(file) : readWithAssimp(file);
  if (!is_ply && !mesh.vertices.empty()) {
    Eigen::Vector3f low = mesh.vertices[0], high = low;
    for (const Eigen::Vector3f& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    if (low.allFinite() && high.allFinite())
      requireFineFloats(file.string(), std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()),
                        (high - low).norm());
  }
  const bool is_cloud = allow_points && is_ply && mesh.triangles.empty() && !mesh.vertices.empty();
  if (mesh.triangles.empty() && !is_cloud)
    throw InputError(file.string() + ": the mesh has no triangles; export it as a triangulated surface.");
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const auto& v) { return v.allFinite(); }))
    throw InputError(file.string() + ": the mesh has vertices that are not finite; repair it first.");
  if (is_cloud) return mesh;
  weld(mesh);
  if (mesh.triangles.empty())
    throw InputError(
        file.string() +
        ": all the mesh's triangles have shrunk to lines or points; check its unit, which must be "
        "metres, and export it with more digits.");
  return mesh;
}

void writePly(const std::filesystem::path& file, const TriangleMesh& mesh) {
  requireConsistent(file, mesh);
  static_assert(std::endian::native == std::endian::little,
                "the values below are copied as they lie in memory");
  std::string bytes = plyHeader(mesh);
  const bool local = mesh.origin.isZero();
  const std::size_t vertex_size =
                        (local ? 12 : 24) + (mesh.normals.empty() ? 0 : 12) + (mesh.colours.empty() ? 0 : 3),
                    triangle_size = 13;
  bytes.reserve(bytes.size() + mesh.vertices.size() * vertex_size + mesh.triangles.size() * triangle_size);
  const auto add = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d placed = mesh.vertices[i].cast<double>() + mesh.origin;
    if (local)
      add(mesh.vertices[i].data(), 12);
    else
      add(placed.data(), 24);
    if (!mesh.normals.empty()) add(mesh.normals[i].data(), 12);
    if (!mesh.colours.empty()) add(mesh.colours[i].data(), 3);
  }
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    add(triangle.data(), 12);
  }
  writeFileAtomically(file, bytes);
}

}  // namespace rosefusion
