// Textures from images: what they look like from where no image was taken, and files that others read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/split_edges.h"
#include "host/export/mesh_formats.h"
#include "host/export/texture/exposure.h"
#include "host/export/texture/texturing.h"
#include "host/synth/sequence.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/locale/foreign_locale.h"

namespace rosefusion::testing {
namespace test_texture {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kHeldOut = 15;  // of the frames: no texture is made of it

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles)
    area += 0.5 * static_cast<double>((mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                          .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                                          .norm());
  return area;
}

double luminance(const cv::Vec3d& bgr) {
  return 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2];
}

/// A generated room, its true surface in triangles of 5 cm, with the mean of the images' colours at its
/// vertices as fusion gives them.
class Room {
 public:
  Room() {
    SynthOptions options;
    options.seed = 2;
    options.frames = 31;
    options.linear = {0.6, 0.9, 1.2};
    options.angular = {0.3, 0.5, 0.8};
    options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
    options.noise = DepthNoise::None;
    options.colour = true;
    sequence_ = makeSequence(options);
    mesh_ = sequence_.mesh;
    mesh_.normals.clear();
    splitLongEdges(mesh_, 0.05f);
    for (std::size_t i = 0; i < sequence_.frames.size(); ++i)
      frames_.push_back({i, sequence_.frames[i].timestamp, i == kHeldOut ? "lost" : "tracked", "",
                         i != kHeldOut, sequence_.truth[i].world_from_camera});
    colourVertices();
  }

  TexturingOptions options() const {
    TexturingOptions options;
    options.camera = sequence_.intrinsics;
    options.depth_units_per_metre = sequence_.depth_units_per_metre;
    options.read = [this](std::size_t i, Frame& frame) {
      frame = sequence_.frames.at(i);
      frame.depth = frame.depth.clone();
      return true;
    };
    return options;
  }

  const TriangleMesh& mesh() const { return mesh_; }
  const std::vector<PageFrame>& frames() const { return frames_; }
  const SynthSequence& sequence() const { return sequence_; }

  /// Mean absolute error of luminance over the held-out view, of 255; `edges`: only where the image has some.
  /// The colour of a surface is asked for by triangle and barycentric weights.
  template <typename Colour>
  double error(const TriangleMesh& mesh, bool edges, const Colour& colour) const {
    Scene scene;
    scene.mesh = mesh;
    const Tracer tracer(scene);
    const cv::Mat& truth = sequence_.frames[kHeldOut].colour;
    const Pose& pose = sequence_.truth[kHeldOut].world_from_camera;
    double sum = 0;
    int count = 0;
    for (int y = 2; y < truth.rows - 2; y += 2)
      for (int x = 2; x < truth.cols - 2; x += 2) {
        const auto at = [&](int dx, int dy) { return luminance(truth.at<cv::Vec3b>(y + dy, x + dx)); };
        if (edges && std::hypot(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1)) < 20) continue;
        const auto hit =
            tracer.cast(pose.translation(), pose.linear() * sequence_.intrinsics.unproject(x, y, 1), 20);
        if (!hit) continue;
        sum += std::abs(luminance(colour(hit->triangle, 1 - hit->u - hit->v, hit->u, hit->v)) - at(0, 0));
        ++count;
      }
    EXPECT_GT(count, 100);
    return sum / count;
  }

 private:
  void colourVertices() {
    std::vector<cv::Vec4d> sums(mesh_.vertices.size());
    for (const PageFrame& frame : frames_) {
      if (!frame.placed) continue;
      const Frame& images = sequence_.frames[frame.number];
      const Pose camera_from_world = frame.world_from_camera.inverse();
      for (std::size_t i = 0; i < sums.size(); ++i) {
        const Eigen::Vector3d p = camera_from_world * mesh_.vertices[i].cast<double>();
        if (p.z() < 0.1) continue;
        const Eigen::Vector2d pixel = sequence_.intrinsics.project(p);
        const cv::Point at(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y())));
        if (!cv::Rect({}, images.depth.size()).contains(at)) continue;
        if (std::abs(images.depth.at<std::uint16_t>(at) / sequence_.depth_units_per_metre - p.z()) > 0.05)
          continue;
        const cv::Vec3b& c = images.colour.at<cv::Vec3b>(at);
        sums[i] += cv::Vec4d(c[0], c[1], c[2], 1);
      }
    }
    mesh_.colours.assign(sums.size(), {90, 90, 90});
    for (std::size_t i = 0; i < sums.size(); ++i)
      for (int k = 0; k < 3 && sums[i][3] > 0; ++k)
        mesh_.colours[i][static_cast<std::size_t>(2 - k)] =
            static_cast<std::uint8_t>(sums[i][k] / sums[i][3]);
  }

  SynthSequence sequence_;
  TriangleMesh mesh_;
  std::vector<PageFrame> frames_;
};

const Room& room() {
  static const Room the_room;
  return the_room;
}

const TexturedMesh& texturedRoom() {
  static const TexturedMesh mesh = textured(room().mesh(), room().frames(), room().options());
  return mesh;
}

/// As a renderer looks it up: bilinearly.
cv::Vec3d texel(const TexturedMesh& textured, std::uint32_t triangle, double a, double b, double c) {
  const auto& t = textured.mesh.triangles[triangle];
  const Eigen::Vector2d uv = a * textured.texture_coordinates[t[0]].cast<double>() +
                             b * textured.texture_coordinates[t[1]].cast<double>() +
                             c * textured.texture_coordinates[t[2]].cast<double>();
  const double x = uv.x() * textured.texture.cols - 0.5, y = uv.y() * textured.texture.rows - 0.5;
  const int left = std::clamp(static_cast<int>(std::floor(x)), 0, textured.texture.cols - 2),
            top = std::clamp(static_cast<int>(std::floor(y)), 0, textured.texture.rows - 2);
  const auto at = [&](int i, int k) { return cv::Vec3d(textured.texture.at<cv::Vec3b>(top + k, left + i)); };
  const double u = x - left, v = y - top;
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

double textureError(const TexturedMesh& mesh, bool edges) {
  return room().error(mesh.mesh, edges,
                      [&](std::uint32_t t, double a, double b, double c) { return texel(mesh, t, a, b, c); });
}

double vertexError(bool edges) {
  const TriangleMesh& mesh = room().mesh();
  return room().error(mesh, edges, [&](std::uint32_t t, double a, double b, double c) {
    cv::Vec3d colour;
    for (int k = 0; k < 3; ++k)
      colour[2 - k] = a * mesh.colours[mesh.triangles[t][0]][static_cast<std::size_t>(k)] +
                      b * mesh.colours[mesh.triangles[t][1]][static_cast<std::size_t>(k)] +
                      c * mesh.colours[mesh.triangles[t][2]][static_cast<std::size_t>(k)];
    return colour;
  });
}

TEST(Texture, EveryTriangleHasItsPlace) {
  const TexturedMesh& mesh = texturedRoom();
  ASSERT_EQ(mesh.texture_coordinates.size(), mesh.mesh.vertices.size());
  for (const Eigen::Vector2f& t : mesh.texture_coordinates) {
    ASSERT_GE(t.minCoeff(), 0);
    ASSERT_LE(t.maxCoeff(), 1);
  }
  EXPECT_EQ(mesh.mesh.triangles.size(), room().mesh().triangles.size()) << "small as they were already";
  EXPECT_NEAR(areaOf(mesh.mesh), areaOf(room().mesh()), 1e-2);
  EXPECT_TRUE(mesh.mesh.colours.empty()) << "which would be multiplied with the texture";
  EXPECT_GT(mesh.charts, 0u);
}

TEST(Texture, ShowsEdgesSharperThanVertexColours) {
  const TexturedMesh& mesh = texturedRoom();
  const double texture_edges = textureError(mesh, true), vertex_edges = vertexError(true);
  const double texture_all = textureError(mesh, false), vertex_all = vertexError(false);
  RecordProperty("edges", std::to_string(texture_edges) + " against " + std::to_string(vertex_edges));
  std::printf(
      "edges %.2f against %.2f, all %.2f against %.2f; %zu views, %zu charts, %zu of %zu unseen, %d x %d\n",
      texture_edges, vertex_edges, texture_all, vertex_all, mesh.views, mesh.charts, mesh.unseen,
      mesh.mesh.triangles.size(), mesh.texture.cols, mesh.texture.rows);
  EXPECT_LT(texture_edges, 0.7 * vertex_edges);
  EXPECT_LT(texture_all, vertex_all);
}

/// Square metres of the triangles that an image shows, which come first.
double seenArea(const TexturedMesh& textured) {
  TriangleMesh seen = textured.mesh;
  seen.triangles.resize(seen.triangles.size() - textured.unseen);
  return areaOf(seen);
}

// No image shows a wall's two triangles whole.
TEST(Texture, LargeTrianglesAreSplitForIt) {
  const TexturedMesh mesh = textured(room().sequence().mesh, room().frames(), room().options());
  EXPECT_GT(mesh.mesh.triangles.size(), room().sequence().mesh.triangles.size());
  EXPECT_NEAR(areaOf(mesh.mesh), areaOf(room().mesh()), 1e-2);
  EXPECT_GT(seenArea(mesh), 0.7 * seenArea(texturedRoom()));
}

TEST(Texture, FitsIntoTheSizeThatIsGiven) {
  TexturingOptions options = room().options();
  options.largest = 2048;
  const TexturedMesh mesh = textured(room().sequence().mesh, room().frames(), options);
  EXPECT_LE(mesh.texture.cols, 2048);
  EXPECT_LE(mesh.texture.rows, 2048);
  options.largest = 16;
  EXPECT_THROW(textured(room().mesh(), room().frames(), options), InputError);
}

TEST(Texture, WhatComesBeforeTheCameraIsNotInIt) {
  TexturingOptions options = room().options();
  const auto read = options.read;
  options.read = [&](std::size_t i, Frame& frame) {
    if (!read(i, frame)) return false;
    frame.colour = frame.colour.clone();
    if (i % 2 == 0) {
      const cv::Rect hand(40, 40, 200, 160);
      frame.colour(hand).setTo(cv::Scalar(0, 0, 255));
      frame.depth(hand).setTo(static_cast<std::uint16_t>(0.3 * room().sequence().depth_units_per_metre));
    }
    return true;
  };
  const TexturedMesh mesh = textured(room().mesh(), room().frames(), options);
  // Looked up on the surface: around charts there may be some of it.
  std::size_t red = 0;
  for (std::uint32_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    const cv::Vec3d colour = texel(mesh, t, 1 / 3.0, 1 / 3.0, 1 / 3.0);
    red += colour[2] > 200 && colour[0] < 50;
  }
  EXPECT_LT(red, mesh.mesh.triangles.size() / 1000);
}

TEST(Texture, BrightnessIsLevelledToTheMeshs) {
  TexturingOptions options = room().options();
  const auto read = options.read;
  options.read = [&](std::size_t i, Frame& frame) {
    if (!read(i, frame)) return false;
    frame.colour = levelled(frame.colour, i % 3 ? Gains(0.6, 0.6, 0.6) : Gains(1.1, 1.2, 1.0));
    return true;
  };
  const double levelled_error = textureError(textured(room().mesh(), room().frames(), options), false);
  EXPECT_LT(levelled_error, textureError(texturedRoom(), false) + 2);
}

TEST(Texture, WithoutImagesThereIsASentence) {
  TexturingOptions options = room().options();
  std::vector<PageFrame> lost = room().frames();
  for (PageFrame& frame : lost) frame.status = "lost";
  const auto message = [&](const std::vector<PageFrame>& frames) -> std::string {
    try {
      textured(room().mesh(), frames, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(lost), HasSubstr("no tracked frame"));
  options.read = [](std::size_t, Frame&) { return false; };
  EXPECT_THAT(message(room().frames()), HasSubstr("--recording"));
}

/// Two triangles, a texture of two colours.
TexturedMesh small() {
  TexturedMesh mesh;
  mesh.mesh.vertices = {{0, 0, 0}, {1.5f, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  mesh.texture_coordinates = {{0.125f, 0.25f}, {0.5f, 0.25f}, {0.125f, 0.75f}, {1, 0.75f}};
  mesh.texture = cv::Mat(16, 32, CV_8UC3, cv::Scalar(10, 20, 200));
  return mesh;
}

TEST(TexturedGlb, HasTheImageInside) {
  const std::string glb = glbOf(small());
  std::uint32_t head[5];
  std::memcpy(head, glb.data(), sizeof(head));
  EXPECT_EQ(head[2], glb.size());
  const auto json = nlohmann::json::parse(glb.substr(20, head[3]));
  const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("TEXCOORD_0"));
  EXPECT_FALSE(attributes.contains("COLOR_0"));
  EXPECT_TRUE(json["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  const auto& view = json["bufferViews"][json["images"][0]["bufferView"].get<std::size_t>()];
  EXPECT_EQ(glb.substr(28 + head[3] + view["byteOffset"].get<std::size_t>(), 2), "\xFF\xD8") << "a JPEG";
}

TEST(TexturedObj, IsReadByAssimpWithItsMaterial) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "my room.obj";
  const TexturedMesh mesh = small();
  writeTexturedObj(file, mesh);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  ASSERT_TRUE(scene) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const aiMesh& read = *scene->mMeshes[0];
  EXPECT_EQ(read.mNumFaces, 2u);
  ASSERT_TRUE(read.HasTextureCoords(0));
  const aiFace& face = read.mFaces[1];
  for (unsigned i = 0; i < 3; ++i) {
    const Eigen::Vector2f& expected = mesh.texture_coordinates[mesh.mesh.triangles[1][i]];
    const aiVector3D& t = read.mTextureCoords[0][face.mIndices[i]];
    EXPECT_NEAR(t.x, expected.x(), 1e-6);
    EXPECT_NEAR(t.y, 1 - expected.y(), 1e-6) << "from the bottom in this format";
  }
  aiString image;
  ASSERT_EQ(scene->mMaterials[read.mMaterialIndex]->GetTexture(aiTextureType_DIFFUSE, 0, &image),
            aiReturn_SUCCESS);
  EXPECT_STREQ(image.C_Str(), "my_room_texture.jpg");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / image.C_Str()));
}

TEST(TexturedFiles, AreTheSameInEveryLocale) {
  const TemporaryFolder folder;
  const auto written = [&] {
    writeTexturedObj(folder.path() / "a.obj", small());
    return readFile(folder.path() / "a.obj") + readFile(folder.path() / "a.mtl") + glbOf(small());
  };
  const std::string expected = written();
  EXPECT_THAT(expected, HasSubstr("vt 0.125000 0.750000"));
  const ForeignLocale foreign("de_DE");
  if (!foreign.available())
    GTEST_SKIP() << "localedef cannot make de_DE; install locales (Debian) to run this.";
  EXPECT_EQ(written(), expected);
}

}  // namespace test_texture
}  // namespace rosefusion::testing
