// Mesh files: round trip, and one sentence for every bad one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "host/error.h"
#include "host/export/mesh_io.h"

namespace rosefusion {
namespace {

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
  EXPECT_EQ(read.colours, mesh.colours);
  EXPECT_EQ(read.triangles, mesh.triangles);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(read.vertices[i], mesh.vertices[i]);
    EXPECT_EQ(read.normals[i], mesh.normals[i]);
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

TEST_F(MeshIo, QuadsAreTriangulatedAndIdenticalVerticesWelded) {
  std::ofstream(folder_ / "quad.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const TriangleMesh mesh = readMesh(folder_ / "quad.obj");
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
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

}  // namespace
}  // namespace rosefusion
