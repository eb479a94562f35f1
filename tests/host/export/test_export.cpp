// Meshes and poses for other programs, what is up, and the page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "host/core/error.h"
#include "host/export/decimation.h"
#include "host/export/mesh_formats.h"
#include "host/export/mesh_io.h"
#include "host/export/page.h"
#include "host/export/pose_formats.h"
#include "host/export/upright.h"

namespace rosefusion::testing {
namespace test_export {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

/// Square of `side` metres in the plane y = 1 (below a camera at the origin), its front towards -y.
TriangleMesh floorMesh(int cells, float side, bool coloured = true) {
  TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i)
    for (int k = 0; k <= cells; ++k) {
      mesh.vertices.emplace_back(side * static_cast<float>(i) / static_cast<float>(cells), 1,
                                 side * static_cast<float>(k) / static_cast<float>(cells));
      mesh.normals.emplace_back(0, -1, 0);
      if (coloured) mesh.colours.push_back({188, 0, static_cast<std::uint8_t>(i % 256)});
    }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * (cells + 1) + k); };
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      mesh.triangles.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

TEST(Decimation, AFlatSurfaceNeedsFewTriangles) {
  const TriangleMesh flat = floorMesh(50, 2);
  const TriangleMesh few = decimated(flat, {0.001, 0});
  EXPECT_LT(few.triangles.size(), flat.triangles.size() / 20);
  EXPECT_EQ(few.vertices.size(), few.colours.size());
  EXPECT_EQ(few.vertices.size(), few.normals.size());
  double area = 0;
  for (const auto& t : few.triangles)
    area +=
        0.5 * (few.vertices[t[1]] - few.vertices[t[0]]).cross(few.vertices[t[2]] - few.vertices[t[0]]).norm();
  EXPECT_NEAR(area, 4, 1e-3) << "its border stays";
}

TEST(Decimation, StopsAtTheErrorAndAtTheCount) {
  TriangleMesh rough = floorMesh(40, 2);
  std::mt19937 random(1);
  for (Eigen::Vector3f& v : rough.vertices) v.y() += 0.05f * static_cast<float>(random() % 1000) / 1000;
  EXPECT_GT(decimated(rough, {0.001, 0}).triangles.size(), rough.triangles.size() / 2);
  const std::size_t count = decimated(rough, {1, 500}).triangles.size();
  EXPECT_LE(count, 500u);
  EXPECT_GT(count, 300u);
}

class ExportedMesh : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, ExportedMesh, ::testing::Values("mesh.glb", "mesh.obj", "mesh.ply"));

TEST_P(ExportedMesh, IsReadAgainByAssimp) {
  const fs::path file = fs::path(::testing::TempDir()) / "rosefusion_export" / GetParam();
  const TriangleMesh mesh = floorMesh(4, 2);
  writeMesh(file, mesh);
  const TriangleMesh read = readMesh(file);
  EXPECT_EQ(read.triangles.size(), mesh.triangles.size());
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  double sum = 0, expected = 0;
  for (const auto& v : read.vertices) sum += v.x() + 10 * v.y() + 100 * v.z();
  for (const auto& v : mesh.vertices) expected += v.x() + 10 * v.y() + 100 * v.z();
  EXPECT_NEAR(sum, expected, 1e-3);
  ASSERT_EQ(read.colours.size(), mesh.colours.size());
  fs::remove_all(file.parent_path());
}

TEST(Glb, HoldsWhatTheFormatAsks) {
  const std::string glb = glbOf(floorMesh(3, 1));
  std::uint32_t head[5];
  std::memcpy(head, glb.data(), sizeof(head));
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(head[1], 2u);
  EXPECT_EQ(head[2], glb.size());
  EXPECT_EQ(head[3] % 4, 0u);
  const auto json = nlohmann::json::parse(glb.substr(20, head[3]));
  EXPECT_EQ(json["accessors"][0]["max"][1], 1);
  const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
  const std::size_t view = json["accessors"][attributes["COLOR_0"].get<std::size_t>()]["bufferView"];
  std::uint16_t red;
  std::memcpy(&red, glb.data() + 28 + head[3] + json["bufferViews"][view]["byteOffset"].get<std::size_t>(),
              2);
  EXPECT_NEAR(red / 65535.0, 0.503, 0.002) << "sRGB 188 is half of the light";
  EXPECT_THAT(glbOf(floorMesh(1, 1, false)), Not(HasSubstr("unlit"))) << "without colours light must show it";
}

TEST(WriteMesh, UnknownEndingsAndEmptyMeshesAreNamed) {
  EXPECT_THROW(writeMesh("/tmp/mesh.step", floorMesh(1, 1)), InputError);
  EXPECT_THROW(writeMesh("/tmp/mesh.glb", TriangleMesh()), InputError);
}

Pose somewhere() {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(std::acos(-1.0) / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  return pose;
}

TEST(PoseFormats, EachHasItsConventions) {
  const Pose pose = somewhere();
  std::istringstream kitti(kittiOf({pose}));
  std::vector<double> numbers((std::istream_iterator<double>(kitti)), {});
  ASSERT_EQ(numbers.size(), 12u);
  EXPECT_NEAR(numbers[1], -1, 1e-9);
  EXPECT_NEAR(numbers[11], 3, 1e-9);

  const Intrinsics k{640, 480, 500, 510, 319.5, 239.5};
  const auto nerf = nlohmann::json::parse(nerfstudioOf(k, {{"images/a.jpg", "depth/a.png", pose}}));
  EXPECT_EQ(nerf["cx"], 320) << "pixel centres lie at halves there";
  const auto& matrix = nerf["frames"][0]["transform_matrix"];
  EXPECT_NEAR(matrix[0][1].get<double>(), 1, 1e-9) << "y is turned up";
  EXPECT_NEAR(matrix[2][2].get<double>(), -1, 1e-9) << "and the camera looks along -z";
  EXPECT_NEAR(matrix[1][3].get<double>(), 2, 1e-9);

  const ColmapModel colmap = colmapOf(k, {{"a.jpg", "", pose}});
  EXPECT_THAT(colmap.cameras, HasSubstr("1 PINHOLE 640 480 500 510 320 240"));
  std::istringstream line(colmap.images.substr(colmap.images.find('\n') + 1));
  double id, qw, qx, qy, qz, x, y, z;
  line >> id >> qw >> qx >> qy >> qz >> x >> y >> z;
  EXPECT_NEAR(x, -2, 1e-9) << "world to camera";
  EXPECT_NEAR(y, 1, 1e-9);
  EXPECT_NEAR(qz, -std::sqrt(0.5), 1e-9);
}

TEST(Upright, TheFloorIsFoundWhereThereIsOne) {
  TriangleMesh room = floorMesh(40, 3);
  // A table, as flat and higher, and a wall.
  for (const TriangleMesh& more : {floorMesh(10, 1), floorMesh(20, 2)}) {
    const auto first = static_cast<std::uint32_t>(room.vertices.size());
    const bool wall = more.vertices.size() > 200;
    for (const Eigen::Vector3f& v : more.vertices)
      room.vertices.push_back(wall ? Eigen::Vector3f(v.x(), v.z() - 1, 3)
                                   : Eigen::Vector3f(v.x(), 0.3f, v.z()));
    for (const auto& t : more.triangles) room.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  room.normals.clear();
  room.colours.clear();
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 0.2, 0.4).normalized()).toRotationMatrix();
  turn(room, tilt);
  const auto up = floorNormal(room, -Eigen::Vector3d::UnitY());
  ASSERT_TRUE(up);
  EXPECT_LT((*up - tilt * -Eigen::Vector3d::UnitY()).norm(), 0.01);
  for (const UpAxis axis : {UpAxis::Y, UpAxis::Z}) {
    const Eigen::Vector3d to = rotationToAxis(*up, axis) * *up;
    EXPECT_NEAR(axis == UpAxis::Y ? to.y() : to.z(), 1, 1e-9);
  }
  EXPECT_FALSE(floorNormal(room, Eigen::Vector3d::UnitX())) << "nothing faces that way";
  EXPECT_FALSE(floorNormal(floorMesh(4, 0.3f), -Eigen::Vector3d::UnitY())) << "too small to be sure";
}

PageContent content(TriangleMesh mesh) {
  PageContent out{"a <b> & c", std::move(mesh)};
  out.frames.push_back({0, 0, "tracked", "", true, Pose::Identity()});
  out.frames.push_back({1, 0.1, "lost", "</script><b>", false, Pose::Identity()});
  return out;
}

TEST(Page, IsOneFileWhoseTextsStayTexts) {
  const std::string page = pageOf(content(floorMesh(10, 1)));
  EXPECT_THAT(page, HasSubstr("<title>a &lt;b> &amp; c</title>"));
  EXPECT_THAT(page, Not(HasSubstr("</script><b>")));
  EXPECT_THAT(page, Not(HasSubstr("src=\"")));
  EXPECT_THAT(page, HasSubstr("\"lost\""));
  EXPECT_THAT(pageOf(content({})), HasSubstr("<script id=\"model\" type=\"text/plain\"></script>"))
      << "without a surface there are still the frames";
}

TEST(Page, ALargeModelStaysUnderTheLimit) {
  TriangleMesh rough = floorMesh(700, 20);
  std::mt19937 random(1);
  for (Eigen::Vector3f& v : rough.vertices) v.y() += 0.2f * static_cast<float>(random() % 1000) / 1000;
  for (auto& c : rough.colours)
    for (std::uint8_t& part : c) part = static_cast<std::uint8_t>(random());
  const std::string page = pageOf(content(std::move(rough)));
  EXPECT_LT(page.size(), kMostPageBytes);
  EXPECT_GT(page.size(), 2'000'000u) << "and keeps what fits";
}

}  // namespace test_export
}  // namespace rosefusion::testing
