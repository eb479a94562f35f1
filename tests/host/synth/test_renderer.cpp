// Rendered depth against what geometry says.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "host/synth/renderer.h"
#include "host/synth/sequence.h"
#include "host/synth/shapes.h"

namespace rosefusion::testing {
namespace test_renderer {

constexpr Intrinsics kCamera{64, 48, 32, 32, 31.5, 23.5};

/// A room 4 x 3 x 2.5 m seen from inside.
Scene boxRoom() {
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const auto grey = shapes.addMaterial({{200, 100, 50}, Pattern::Plain, 1});
  shapes.quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, grey);
  shapes.quad({0, 0, 2.5}, {0, 3, 0}, {4, 0, 0}, grey);
  shapes.quad({0, 0, 0}, {0, 0, 2.5}, {4, 0, 0}, grey);
  shapes.quad({0, 3, 0}, {4, 0, 0}, {0, 0, 2.5}, grey);
  shapes.quad({0, 0, 0}, {0, 3, 0}, {0, 0, 2.5}, grey);
  shapes.quad({4, 0, 0}, {0, 0, 2.5}, {0, 3, 0}, grey);
  paintVertices(scene);
  return scene;
}

/// Depth along the optical axis at which the ray leaves the box.
double analyticDepth(const Pose& pose, const Eigen::Vector3d& direction_camera) {
  const Eigen::Vector3d o = pose.translation(), d = pose.linear() * direction_camera, size(4, 3, 2.5);
  double nearest = 1e9;
  for (int axis = 0; axis < 3; ++axis)
    if (d[axis] != 0) nearest = std::min(nearest, ((d[axis] > 0 ? size[axis] : 0) - o[axis]) / d[axis]);
  return nearest;
}

Pose slantedPose() {
  return Eigen::Translation3d(1.3, 1.1, 1.4) * lookAlong({0.8, 0.5, -0.3}, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Pose::Identity();
}

TEST(Renderer, DepthInABoxIsTheAnalyticOne) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  const cv::Mat depth = renderDepth(tracer, kCamera, slantedPose(), 10);
  ASSERT_EQ(depth.type(), CV_32FC1);
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u)
      ASSERT_NEAR(depth.at<float>(v, u), analyticDepth(slantedPose(), kCamera.unproject(u, v, 1)), 1e-5)
          << u << ' ' << v;
}

TEST(Renderer, NegativeFyTurnsTheImageUpsideDown) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  Intrinsics flipped = kCamera;
  flipped.fy = -kCamera.fy;
  const cv::Mat depth = renderDepth(tracer, kCamera, slantedPose()),
                other = renderDepth(tracer, flipped, slantedPose());
  for (int v = 0; v < kCamera.height; ++v)
    EXPECT_NEAR(depth.at<float>(v, 20), other.at<float>(kCamera.height - 1 - v, 20), 1e-5);
}

TEST(Renderer, BeyondTheLargestDepthReadsZero) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  const cv::Mat all = renderDepth(tracer, kCamera, slantedPose(), 10),
                some = renderDepth(tracer, kCamera, slantedPose(), 1.5);
  int cut = 0;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const float whole = all.at<float>(v, u);
      EXPECT_EQ(some.at<float>(v, u), whole <= 1.5f ? whole : 0.0f);
      cut += whole > 1.5f;
    }
  EXPECT_GT(cut, 100);
}

TEST(Renderer, SeenTrianglesAreThoseInView) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  std::vector<std::uint8_t> seen(scene.mesh.triangles.size(), 0);
  renderDepth(tracer, kCamera, slantedPose(), 10, &seen);
  const TriangleMesh part = seenPart(scene.mesh, seen);
  EXPECT_GT(part.triangles.size(), 100u);
  EXPECT_LT(part.triangles.size(), scene.mesh.triangles.size() / 2);
  for (const Eigen::Vector3f& v : part.vertices) {
    const Eigen::Vector3d in_camera = slantedPose().inverse() * v.cast<double>();
    EXPECT_GT(in_camera.z(), -0.2);  // a triangle is at most 0.17 m long
  }
}

TEST(Renderer, ColourIsTheMaterialsShaded) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  const cv::Mat colour = renderColour(tracer, kCamera, slantedPose());
  ASSERT_EQ(colour.type(), CV_8UC3);
  const cv::Vec3b bgr = colour.at<cv::Vec3b>(24, 32);
  EXPECT_NEAR(bgr[2] / double(bgr[1]), 2, 0.1);  // red : green of the material
  EXPECT_NEAR(bgr[1] / double(bgr[0]), 2, 0.1);
}

TEST(Tracer, ClearanceIsTheDistanceToTheNearestWall) {
  const Scene scene = boxRoom();
  const Tracer tracer(scene);
  EXPECT_NEAR(tracer.clearance({1.0, 0.6, 1.2}, 5), 0.6, 1e-6);
  EXPECT_NEAR(tracer.clearance({2.0, 1.5, 2.3}, 5), 0.2, 1e-6);
  EXPECT_EQ(tracer.clearance({2.0, 1.5, 1.2}, 0.35), 0.35);
}

TEST(Shapes, SolidsFaceOutwards) {
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const auto grey = shapes.addMaterial({});
  // The divergence theorem: outward triangles sum to the solid's volume.
  const auto volume = [&] {
    double sum = 0;
    for (const auto& t : scene.mesh.triangles)
      sum += scene.mesh.vertices[t[0]].cross(scene.mesh.vertices[t[1]]).dot(scene.mesh.vertices[t[2]]) / 6;
    scene.mesh = {};
    scene.face_material.clear();
    return sum;
  };
  shapes.at({5, 1, 2}, 0.4).box({1, 2, 0.5}, grey);
  EXPECT_NEAR(volume(), 1, 1e-4);
  shapes.at({1, 1, 0}).frustum(0.5, 0.5, 2, grey);
  EXPECT_NEAR(volume(), 1.5708, 0.03);
  shapes.at({1, 2, 3}).ellipsoid({0.3, 0.5, 0.4}, grey);
  EXPECT_NEAR(volume(), 4.18879 * 0.06, 0.01);
}

}  // namespace test_renderer
}  // namespace rosefusion::testing
