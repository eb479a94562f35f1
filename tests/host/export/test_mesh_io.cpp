// Mesh files: round trip, and one sentence for every bad one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "host/core/error.h"
#include "host/export/mesh_io.h"

namespace rosefusion::testing {
namespace test_mesh_io {

namespace fs = std::filesystem;

class MeshIo : public ::testing::Test {
 protected:
  MeshIo() {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("mesh_io_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~MeshIo() override { fs::remove_all(folder_); }

  std::string errorOfReading(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    try {
      readMesh(folder_ / name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1.25f, 0, 0}, {0, -2.5f, 0}, {0, 0, 3.0f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST_F(MeshIo, RoundTripKeepsGeometryAndColours) {
  TriangleMesh mesh = tetrahedron();
  mesh.colours = {{255, 0, 1}, {10, 20, 30}, {128, 127, 126}, {254, 255, 0}};
  for (const Eigen::Vector3f& v : mesh.vertices)
    mesh.normals.push_back((v + Eigen::Vector3f(0, 0, 1)).normalized());
  writePly(folder_ / "mesh.ply", mesh);
  const TriangleMesh read = readMesh(folder_ / "mesh.ply");
  ASSERT_EQ(read.vertices.size(), 4u);
  ASSERT_EQ(read.normals.size(), 4u);
  ASSERT_EQ(read.triangles.size(), 4u);
  ASSERT_EQ(read.colours.size(), 4u);
  for (int t = 0; t < 4; ++t)
    for (int k = 0; k < 3; ++k) {  // vertices may come back in another order
      const std::uint32_t a = mesh.triangles[t][k], b = read.triangles[t][k];
      EXPECT_EQ(read.vertices[b], mesh.vertices[a]);
      EXPECT_EQ(read.normals[b], mesh.normals[a]);
      EXPECT_EQ(read.colours[b], mesh.colours[a]);
    }
}

TEST_F(MeshIo, FileIsBinaryLittleEndianPly) {
  TriangleMesh mesh = tetrahedron();
  mesh.colours.assign(4, {1, 2, 3});
  writePly(folder_ / "mesh.ply", mesh);
  std::ifstream in(folder_ / "mesh.ply", std::ios::binary);
  std::string header(600, '\0');
  in.read(header.data(), 600);
  EXPECT_THAT(header, ::testing::HasSubstr("format binary_little_endian"));
  EXPECT_THAT(header, ::testing::HasSubstr("property float x"));
  EXPECT_THAT(header, ::testing::HasSubstr("property uchar red"));
  for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_EQ(entry.path().filename(), "mesh.ply");
}

TEST_F(MeshIo, QuadsAreSplitAndVerticesWelded) {
  std::ofstream(folder_ / "quad.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const TriangleMesh mesh = readMesh(folder_ / "quad.obj");
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

// assimp 5.2 loses the first data byte where it looks like a line end, a space or a tab.
TEST_F(MeshIo, BinaryDataMayStartWithAnyByte) {
  for (const unsigned byte : {0x0Au, 0x0Du, 0x20u, 0x09u, 0x00u}) {
    TriangleMesh mesh = tetrahedron();
    const std::uint32_t bits = 0x3FB2C200u | byte;
    std::memcpy(mesh.vertices[0].data(), &bits, 4);
    writePly(folder_ / "mesh.ply", mesh);
    const TriangleMesh read = readMesh(folder_ / "mesh.ply");
    ASSERT_EQ(read.triangles.size(), 4u);
    EXPECT_EQ(read.vertices[0], mesh.vertices[0]) << byte;
  }
}

TEST_F(MeshIo, TextPlyWithPolygonsIsRead) {
  std::ofstream(folder_ / "mesh.ply")
      << "ply\r\nformat ascii 1.0\r\ncomment hello\r\nelement vertex 4\r\n"
         "property double x\r\nproperty float quality\r\nproperty double y\r\n"
         "property double z\r\nproperty float red\r\nproperty float green\r\n"
         "property float blue\r\nelement thing 1\r\nproperty list uchar int ids\r\n"
         "element face 1\r\nproperty uchar flag\r\n"
         "property list uchar uint vertex_index\r\nend_header\r\n"
         "0 9 0 0 1 0 0\r\n1 9 0 0 1 0 0\r\n1 9 1 0 0 1 0\r\n0 9 1 0.5 0 0 1\r\n"
         "3 1 2 3\r\n7 4 0 1 2 3\r\n";
  const TriangleMesh mesh = readMesh(folder_ / "mesh.ply");
  ASSERT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.vertices[3], Eigen::Vector3f(0, 1, 0.5f));
  EXPECT_EQ(mesh.colours[0], (std::array<std::uint8_t, 3>{255, 0, 0}));
  EXPECT_THAT(mesh.triangles, ::testing::ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2},
                                                     std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST_F(MeshIo, BigEndianPlyIsRead) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const float values[] = {0, 0, 0, 1.5f, 0, 0, 0, -2.25f, 0};
  const auto add = [&](std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(word >> shift & 0xFF));
  };
  for (const float value : values) add(std::bit_cast<std::uint32_t>(value));
  bytes.push_back(3);
  for (const std::uint32_t index : {0u, 1u, 2u}) add(index);
  std::ofstream(folder_ / "big.ply", std::ios::binary) << bytes;
  const TriangleMesh mesh = readMesh(folder_ / "big.ply");
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3f(0, -2.25f, 0));
}

TEST_F(MeshIo, EqualVerticesAreWelded) {
  TriangleMesh mesh = tetrahedron();
  TriangleMesh soup;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  writePly(folder_ / "soup.ply", soup);
  EXPECT_EQ(readMesh(folder_ / "soup.ply").vertices.size(), 4u);
}

TEST_F(MeshIo, BadFilesEndInOneSentenceThatNamesThem) {
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_THROW(readMesh(folder_ / "absent.ply"), InputError);
  EXPECT_THAT(errorOfReading("text.ply", "not a mesh\n"), HasSubstr("text.ply"));
  EXPECT_THAT(errorOfReading("note.xyzzy", "hello\n"), HasSubstr("note.xyzzy"));
  EXPECT_THAT(errorOfReading(
                  "empty.ply",
                  "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"),
              HasSubstr("empty.ply"));
  EXPECT_THAT(errorOfReading("points.ply",
                             "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                             "property float z\nend_header\n0 0 0\n1 1 1\n"),
              HasSubstr("points.ply"));
  EXPECT_THAT(
      errorOfReading("nan.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
      HasSubstr("nan.ply"));
}

TEST_F(MeshIo, PointCloudsAreReadWhereAllowed) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 0\n1 1 1\n";
  EXPECT_THAT(errorOfReading("points.ply", points), ::testing::HasSubstr("no triangles"));
  const TriangleMesh cloud = readMesh(folder_ / "points.ply", true);
  EXPECT_TRUE(cloud.triangles.empty());
  EXPECT_THAT(cloud.vertices, ::testing::ElementsAre(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 1, 1)));
}

TEST_F(MeshIo, MeshesThatShrankToNothingAreRefused) {
  const std::string flat =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n0 0 0\n1 0 0\n3 0 1 2\n";
  EXPECT_THAT(errorOfReading("flat.ply", flat),
              ::testing::AllOf(::testing::HasSubstr("flat.ply"), ::testing::HasSubstr("shrunk")));
  EXPECT_THROW(readMesh(folder_ / "flat.ply", true), InputError) << "nor is it a point cloud";
}

TEST_F(MeshIo, DamagedFilesAreRefused) {
  EXPECT_THAT(
      errorOfReading("index.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 7000000\n"),
      ::testing::HasSubstr("damaged"));
  writePly(folder_ / "cut.ply", tetrahedron());
  fs::resize_file(folder_ / "cut.ply", fs::file_size(folder_ / "cut.ply") - 20);
  EXPECT_THROW(readMesh(folder_ / "cut.ply"), InputError);
}

TEST_F(MeshIo, RefusesToWriteWhatIsNotASurface) {
  EXPECT_THROW(writePly(folder_ / "none.ply", {}), InputError);
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_THROW(writePly(folder_ / "index.ply", mesh), InputError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

std::string georeferenced(const std::string& type, const Eigen::Vector3d& at) {
  std::ostringstream text;
  text.precision(12);
  text << "ply\nformat ascii 1.0\nelement vertex 3\nproperty " << type << " x\nproperty " << type
       << " y\nproperty " << type
       << " z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const double x : {0.0, 2.125, 0.125})
    text << at.x() + x << ' ' << at.y() + 2 * x * x << ' ' << at.z() << '\n';
  return text.str() + "3 0 1 2\n";
}

TEST_F(MeshIo, LargeCoordinatesKeepTheirDigits) {
  const Eigen::Vector3d utm(500000.25, 5400000.375, 300);
  std::ofstream(folder_ / "utm.ply") << georeferenced("double", utm);
  const TriangleMesh mesh = readMesh(folder_ / "utm.ply");
  ASSERT_EQ(mesh.vertices.size(), 3u);
  const auto placed = [](const TriangleMesh& m, std::size_t i) -> Eigen::Vector3d {
    return m.vertices[i].cast<double>() + m.origin;
  };
  EXPECT_EQ(placed(mesh, 1).x(), 500002.375);
  EXPECT_EQ(placed(mesh, 2).y(), 5400000.375 + 0.03125);
  writePly(folder_ / "again.ply", mesh);
  const TriangleMesh again = readMesh(folder_ / "again.ply");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(placed(again, i), placed(mesh, i));
  std::ofstream(folder_ / "local.ply") << georeferenced("double", {3, 4, 0});
  EXPECT_TRUE(readMesh(folder_ / "local.ply").origin.isZero());
}

TEST_F(MeshIo, CoordinatesThatFloatsRoundedAreRefused) {
  EXPECT_THAT(errorOfReading("copy.obj",
                             "v 500000.25 5400000.375 300\nv 500002.25 5400000.375 300\n"
                             "v 500000.25 5400002.375 300\nf 1 2 3\n"),
              ::testing::HasSubstr("double coordinates"));
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const float value : {500000.f, 5400000.f, 3.f, 500002.f, 5400000.f, 3.f, 500000.f, 5400002.f, 3.f})
    binary.append(reinterpret_cast<const char*>(&value), 4);
  binary += std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  EXPECT_THAT(errorOfReading("rounded.ply", binary), ::testing::HasSubstr("double coordinates"));
}

}  // namespace test_mesh_io
}  // namespace rosefusion::testing
