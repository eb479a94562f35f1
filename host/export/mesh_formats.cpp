#include "host/export/mesh_formats.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/export/mesh_io.h"

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

/// glTF's colours are linear; images hold sRGB.
std::uint16_t linearOf(std::uint8_t srgb) {
  const double c = srgb / 255.0;
  const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535 * linear));
}

/// The parts of a .glb's binary chunk, each at a multiple of four bytes.
class Buffer {
 public:
  /// The view's index. `target`: what a device uses it for; 0: it does not.
  std::size_t add(const void* data, std::size_t size, int target) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}});
    if (target) views_.back()["target"] = target;
    bytes_.append(static_cast<const char*>(data), size);
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    return views_.size() - 1;
  }
  const std::string& bytes() const { return bytes_; }
  const Json& views() const { return views_; }

 private:
  std::string bytes_;
  Json views_ = Json::array();
};

void appendChunk(std::string& out, const char* type, const std::string& bytes) {
  const auto length = static_cast<std::uint32_t>(bytes.size());
  out.append(reinterpret_cast<const char*>(&length), 4);
  out.append(type, 4);
  out += bytes;
}

std::string jpegOf(const cv::Mat& image) {
  constexpr int kQuality = 95;  // less is seen at the edges of what is coloured
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return {bytes.begin(), bytes.end()};
}

/// `textured`: what the mesh is part of, or null.
std::string glb(const TriangleMesh& mesh, const TexturedMesh* textured);
std::string obj(const TriangleMesh& mesh, const TexturedMesh* textured, const std::string& materials);

}  // namespace

bool hasColours(const TriangleMesh& mesh) {
  const auto differs = [&](const auto& colour) { return colour != mesh.colours.front(); };
  return std::any_of(mesh.colours.begin(), mesh.colours.end(), differs);
}

std::string glbOf(const TriangleMesh& mesh) {
  return glb(mesh, nullptr);
}

std::string glbOf(const TexturedMesh& textured) {
  return glb(textured.mesh, &textured);
}

std::string objOf(const TriangleMesh& mesh) {
  return obj(mesh, nullptr, "");
}

void writeTexturedObj(const std::filesystem::path& file, const TexturedMesh& textured) {
  std::string name = file.stem().string();
  std::replace(name.begin(), name.end(), ' ', '_');
  const std::string image = name + "_texture.jpg", materials = name + ".mtl";
  writeFileAtomically(file.parent_path() / image, jpegOf(textured.texture));
  writeFileAtomically(
      file.parent_path() / materials,
      "# rosefusion\nnewmtl texture\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " + image + "\n");
  writeFileAtomically(file, obj(textured.mesh, &textured, materials));
}

namespace {

std::string glb(const TriangleMesh& mesh, const TexturedMesh* textured) {
  constexpr int kVertices = 34962, kIndices = 34963, kFloat = 5126, kShort = 5123, kInt = 5125;
  Eigen::Vector3f low = mesh.vertices.at(0), high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  Buffer buffer;
  Json accessors = Json::array(), attributes = Json::object();
  const auto addAccessor = [&](std::size_t view, int component, std::size_t count, const char* type) {
    accessors.push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
  };
  const std::size_t count = mesh.vertices.size();
  attributes["POSITION"] =
      addAccessor(buffer.add(mesh.vertices.data(), 12 * count, kVertices), kFloat, count, "VEC3");
  accessors[0]["min"] = {low.x(), low.y(), low.z()};
  accessors[0]["max"] = {high.x(), high.y(), high.z()};
  if (!mesh.normals.empty()) {
    std::vector<Eigen::Vector3f> normals = mesh.normals;
    for (Eigen::Vector3f& n : normals) n = n.norm() > 0.5f ? n.normalized() : Eigen::Vector3f::UnitY();
    attributes["NORMAL"] =
        addAccessor(buffer.add(normals.data(), 12 * count, kVertices), kFloat, count, "VEC3");
  }
  Json material = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                   {"doubleSided", true}};
  Json root = {{"asset", {{"version", "2.0"}, {"generator", "rosefusion"}}}};
  const auto setUnlit = [&] {
    material["extensions"]["KHR_materials_unlit"] = Json::object();
    root["extensionsUsed"] = {"KHR_materials_unlit"};
  };
  if (textured) {
    const std::size_t view = buffer.add(textured->texture_coordinates.data(), 8 * count, kVertices);
    attributes["TEXCOORD_0"] = addAccessor(view, kFloat, count, "VEC2");
    const std::string image = jpegOf(textured->texture);
    root["images"] = {
        {{"bufferView", buffer.add(image.data(), image.size(), 0)}, {"mimeType", "image/jpeg"}}};
    constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kClampToEdge = 33071;
    root["samplers"] = {{{"magFilter", kLinear},
                         {"minFilter", kLinearMipmapLinear},
                         {"wrapS", kClampToEdge},
                         {"wrapT", kClampToEdge}}};
    root["textures"] = {{{"sampler", 0}, {"source", 0}}};
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    setUnlit();
  } else if (hasColours(mesh)) {
    std::vector<std::array<std::uint16_t, 4>> colours;
    for (const auto& c : mesh.colours)
      colours.push_back({linearOf(c[0]), linearOf(c[1]), linearOf(c[2]), 65535});
    const std::size_t view = buffer.add(colours.data(), 8 * count, kVertices);
    attributes["COLOR_0"] = addAccessor(view, kShort, count, "VEC4");
    accessors.back()["normalized"] = true;
    setUnlit();
  }
  const std::size_t indices = 3 * mesh.triangles.size();
  const std::size_t index_accessor =
      addAccessor(buffer.add(mesh.triangles.data(), 4 * indices, kIndices), kInt, indices, "SCALAR");
  root["scene"] = 0;
  root["scenes"] = {{{"nodes", {0}}}};
  root["nodes"] = {{{"mesh", 0}, {"name", "reconstruction"}}};
  if (!mesh.origin.isZero())
    root["nodes"][0]["translation"] = {mesh.origin.x(), mesh.origin.y(), mesh.origin.z()};
  root["meshes"] = {
      {{"primitives", {{{"attributes", attributes}, {"indices", index_accessor}, {"material", 0}}}}}};
  root["materials"] = {material};
  root["accessors"] = accessors;
  root["bufferViews"] = buffer.views();
  root["buffers"] = {{{"byteLength", buffer.bytes().size()}}};

  std::string json = root.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out = "glTF";
  const std::uint32_t head[] = {2,
                                static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.bytes().size())};
  out.append(reinterpret_cast<const char*>(head), sizeof(head));
  appendChunk(out, "JSON", json);
  appendChunk(out, std::string("BIN\0", 4).c_str(), buffer.bytes());
  return out;
}

std::string obj(const TriangleMesh& mesh, const TexturedMesh* textured, const std::string& materials) {
  TextStream out;
  out << "# rosefusion, metres\n" << std::fixed;
  if (textured) out << "mtllib " << materials << "\nusemtl texture\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d v = mesh.vertices[i].cast<double>() + mesh.origin;
    out << printed("v %.5f %.5f %.5f", v.x(), v.y(), v.z());
    if (!mesh.colours.empty()) {
      const auto& c = mesh.colours[i];
      out << printed(" %.4f %.4f %.4f", c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
    }
    out << '\n';
  }
  if (textured)  // from the bottom here, and to a tenth of a texel of the largest textures
    for (const Eigen::Vector2f& t : textured->texture_coordinates)
      out << printed("vt %.6f %.6f\n", double(t.x()), 1 - double(t.y()));
  for (const Eigen::Vector3f& n : mesh.normals)
    out << printed("vn %.4f %.4f %.4f\n", double(n.x()), double(n.y()), double(n.z()));
  for (const auto& t : mesh.triangles) {
    out << 'f';
    for (const std::uint32_t v : t) {
      out << ' ' << v + 1;
      if (textured || !mesh.normals.empty()) out << '/';
      if (textured) out << v + 1;
      if (!mesh.normals.empty()) out << '/' << v + 1;
    }
    out << '\n';
  }
  return out.str();
}

}  // namespace

void writeMesh(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const std::string ending = lowered(file.extension().string());
  if (mesh.triangles.empty())
    throw InputError(file.string() + ": not written, because the mesh has no triangles.");
  if (ending == ".ply")
    writePly(file, mesh);
  else if (ending == ".glb")
    writeFileAtomically(file, glbOf(mesh));
  else if (ending == ".obj")
    writeFileAtomically(file, objOf(mesh));
  else
    throw InputError(file.string() + ": meshes are written as .glb, .obj or .ply; end its name so.");
}

}  // namespace rosefusion
