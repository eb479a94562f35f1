// Pass raycast against its reference, against the true surface, and at its limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/passes/raycast.h"
#include "tests/engine/surface_scene.h"
#include "tests/reference/packed_surface.h"
#include "tests/reference/raycast.h"

namespace rosefusion::testing {
namespace test_raycast {

using Eigen::Vector3d;

constexpr int kWidth = 160, kHeight = 120;
constexpr float kFocal = 120;
constexpr float kNear = 0.05f, kFar = 6.0f;

// The pass ends with one Newton step on a field that is curved by less than a voxel's noise; the reference
// bisects.
constexpr double kDistanceToleranceVoxels = 0.02;
// The gradient changes by at most a few degrees per voxel, so that the shift above turns the normal by far
// less.
constexpr double kNormalToleranceDegrees = 1.0;
// Distances measured along the cameras' rays bend the field off a curved surface, most where it was seen
// aslant.
constexpr double kTrueNormalDegrees = 20;
// Rays that graze an edge may decide differently: the pass looks for the front of a surface in single voxels,
// the reference in interpolated samples.
constexpr double kAgreeingShare = 0.98;

shader::CameraIntrinsics viewCamera() {
  return {glm::vec4(kFocal, kFocal, 0.5f * (kWidth - 1), 0.5f * (kHeight - 1)),
          glm::ivec4(kWidth, kHeight, 0, 0)};
}

struct View {
  std::vector<glm::vec4> vertices;  // world frame, w = 1; all 0 where nothing was hit
  std::vector<glm::vec4> normals;
  std::vector<std::uint32_t> preview;
  std::size_t hits() const {
    return std::count_if(vertices.begin(), vertices.end(), [](const glm::vec4& v) { return v.w > 0; });
  }
};

/// Unit direction in the world through a pixel, and how much of it is depth.
std::pair<Vector3d, double> rayThrough(const Eigen::Isometry3d& pose, int pixel, double focal = kFocal) {
  const Vector3d ray((pixel % kWidth - 0.5 * (kWidth - 1)) / focal,
                     (pixel / kWidth - 0.5 * (kHeight - 1)) / focal, 1);
  return {pose.linear() * ray.normalized(), 1 / ray.norm()};
}

View cast(Device& device, SurfaceScene& scene, const Eigen::Isometry3d& pose, float near = kNear,
          float far = kFar, const shader::CameraIntrinsics& camera = viewCamera()) {
  RaycastPass pass(device, camera);
  pass.record(scene.recorder, scene.volume, {toGlm(pose), near, far, true});
  scene.recorder.submit();
  View view;
  const auto words = download<std::uint32_t>(device, pass.surface());
  for (std::size_t i = 0; i < 2 * pass.preview().size(); i += 2) {
    const Eigen::Vector4d surface = reference::unpackedSurface(words[i], words[i + 1]);
    view.normals.emplace_back(surface.x(), surface.y(), surface.z(), surface.w());
  }
  view.preview.assign(pass.preview().begin(), pass.preview().end());
  for (std::size_t pixel = 0; pixel < view.normals.size(); ++pixel) {
    const auto [direction, depth_share] = rayThrough(pose, static_cast<int>(pixel));
    const double depth = view.normals[pixel].w;
    const Vector3d p = pose.translation() + depth / depth_share * direction;
    view.vertices.push_back(depth > 0 ? glm::vec4(p.x(), p.y(), p.z(), 1) : glm::vec4(0));
  }
  return view;
}

struct Agreement {
  int pixels = 0, hits = 0, agreeing = 0;
  double share() const { return double(agreeing) / pixels; }
};

Agreement compare(const View& view, const reference::Field& field, const Eigen::Isometry3d& pose,
                  double voxel_size, double focal = kFocal) {
  Agreement result;
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const auto [direction, depth_share] = rayThrough(pose, pixel, focal);
    const auto hit =
        reference::castRay(field, pose.translation(), direction, kNear / depth_share, kFar / depth_share);
    const glm::vec4 v = view.vertices[pixel], n = view.normals[pixel];
    ++result.pixels;
    result.hits += hit.hit;
    if (!hit.hit || v.w == 0) {
      result.agreeing += !hit.hit && v.w == 0;
      continue;
    }
    const Vector3d expected = pose.translation() + hit.distance * direction;
    // Along the normal: a ray that grazes the surface turns the smallest offset into a long way along the
    // ray.
    const double off =
        (Vector3d(v.x, v.y, v.z) - expected).norm() * std::abs(direction.dot(hit.normal)) / voxel_size;
    const double cosine = std::min(1.0, Vector3d(n.x, n.y, n.z).dot(hit.normal));
    result.agreeing +=
        off < kDistanceToleranceVoxels && std::acos(cosine) * 180 / M_PI < kNormalToleranceDegrees;
  }
  return result;
}

class Raycast : public SurfaceTest {
 protected:
  SurfaceScene& scene(bool colour = false) {
    if (!scene_) {
      scene_.emplace(device, SceneOptions{.colour = colour});
      for (const auto& pose : posesAllAround()) scene_->fuse(pose);
    }
    return *scene_;
  }

 private:
  std::optional<SurfaceScene> scene_;
};

TEST_F(Raycast, AgreesWithTheReference) {
  const reference::Field field = scene().field();
  for (const auto& pose : {posesAllAround()[1], lookAt({0.9, 0.5, -1.1}, {0.1, -0.1, 0}),
                           lookAt({1.2, 1.1, 1.3}, {-1, 1.5, 0})}) {
    const Agreement result = compare(cast(device, scene(), pose), field, pose, field.voxelSize());
    EXPECT_GT(result.share(), kAgreeingShare);
    EXPECT_GT(result.hits, result.pixels / 2);
  }
}

TEST_F(Raycast, AgreementIsLostWhenACoefficientIsWrong) {
  const auto pose = posesAllAround()[1];
  const View view = cast(device, scene(), pose);
  const reference::Field field = scene().field();
  EXPECT_LT(compare(view, field, pose, field.voxelSize(), 1.01 * kFocal).share(), 0.5) << "focal length";
  const reference::Field larger = scene().field(1.01);
  EXPECT_LT(compare(view, larger, pose, field.voxelSize()).share(), 0.5) << "voxel size";
}

TEST_F(Raycast, FindsTheTrueSurface) {
  const auto pose = lookAt({0.9, 0.5, -1.1}, {0, 0, 0});
  const View view = cast(device, scene(), pose);
  const double voxel = scene().volume.options().voxel_size;
  int hits = 0, near_truth = 0, upright = 0, on_sphere = 0;
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const glm::vec4 v = view.vertices[pixel], n = view.normals[pixel];
    if (v.w == 0) continue;
    const Vector3d p(v.x, v.y, v.z);
    const double off =
        std::min(std::abs(p.norm() - kSphereRadius), std::abs(p.cwiseAbs().maxCoeff() - kBoxHalf));
    ++hits;
    near_truth += off < 0.5 * voxel;
    if (p.norm() > kSphereRadius + voxel) continue;
    ++on_sphere;
    upright += Vector3d(n.x, n.y, n.z).dot(p.normalized()) > std::cos(kTrueNormalDegrees * M_PI / 180);
  }
  EXPECT_GT(hits, kWidth * kHeight * 95 / 100);
  EXPECT_GT(near_truth, hits * 98 / 100);
  EXPECT_GT(on_sphere, 2000);
  EXPECT_GT(upright, on_sphere * 98 / 100);
}

TEST_F(Raycast, RepeatsExactly) {
  const auto pose = posesAllAround()[4];
  const View first = cast(device, scene(), pose), second = cast(device, scene(), pose);
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.normals, second.normals);
  EXPECT_EQ(first.preview, second.preview);
}

TEST_F(Raycast, KeepsToItsDepthLimits) {
  const auto pose = posesAllAround()[1];
  const double to_sphere = kCameraDistance - kSphereRadius;
  EXPECT_EQ(cast(device, scene(), pose, kNear, float(0.9 * to_sphere)).hits(), 0u);
  // From inside the sphere on: its front is not seen, and its back is no surface seen from there.
  const float near = float(kCameraDistance);
  const View view = cast(device, scene(), pose, near);
  const double voxel = scene().volume.options().voxel_size;
  EXPECT_GT(view.hits(), 1000u);
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const glm::vec4 v = view.vertices[pixel];
    if (v.w == 0) continue;
    const Vector3d p(v.x, v.y, v.z);
    EXPECT_GT((p - pose.translation()).dot(pose.linear().col(2)), near - voxel);
    const auto [direction, depth_share] = rayThrough(pose, pixel);
    const Vector3d start = pose.translation() + near / depth_share * direction;
    if (start.norm() > kSphereRadius - 2 * voxel) continue;  // grazes the sphere from the outside
    EXPECT_GT(p.norm(), kSphereRadius + 0.1);
  }
}

TEST_F(Raycast, ShowsNothingFromBehindASurface) {
  // A wall at z = 1, seen from the origin only.
  SurfaceScene wall(device, {});
  const Eigen::Isometry3d front = lookAt({0, 0, 0}, {0, 0, 1});
  wall.fuse(front, [](const Vector3d&, const Vector3d& direction) { return 1 / direction.z(); });
  const std::size_t pixels = kWidth * kHeight;
  EXPECT_GT(cast(device, wall, front).hits(), pixels * 98 / 100);
  EXPECT_EQ(cast(device, wall, lookAt({0, 0, 2}, {0, 0, 1})).hits(), 0u);
  EXPECT_EQ(cast(device, wall, lookAt({0.4, 0.3, 1.8}, {0, 0, 1})).hits(), 0u);
  EXPECT_EQ(cast(device, wall, lookAt({0, 0, 1.02}, {0, 0, 2})).hits(), 0u)
      << "from inside the wall, looking out";
}

TEST_F(Raycast, AxisRaysCrossAnEmptyBlockInOneStep) {
  // A strip at 0.5 m, and below it one at 2.5 m, 1000 voxels farther on. The rays of the middle column do not
  // move along x, and those below the strip's edge start at its depth.
  SurfaceScene strips(device, {.voxel_size = 0.002f});
  const auto distance = [](const Vector3d& origin, const Vector3d& direction) {
    const Vector3d ray = direction / direction.z();
    if (std::abs(ray.x()) > 0.05 || std::abs(ray.y()) > 0.08) return 0.0;
    const bool on_near = origin.y() + 0.5 * ray.y() < 0;
    return (on_near ? 0.5 : 2.5) * ray.norm();
  };
  // Blocks are smaller here than what two pixels see at 2.5 m: from one place some would be left out.
  for (const double x : {-0.016, 0.0, 0.016})
    for (const double y : {-0.016, 0.0, 0.016}) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() << x, y, 0;
      strips.fuse(pose, distance);
    }
  shader::CameraIntrinsics camera = viewCamera();
  constexpr int kMiddle = kWidth / 2;
  camera.focal_centre.z = kMiddle;
  const View view = cast(device, strips, Eigen::Isometry3d::Identity(), kNear, kFar, camera);
  for (int v = kHeight / 2 + 1; v < kHeight / 2 + 4; ++v)
    for (const int u : {kMiddle - 1, kMiddle, kMiddle + 1})
      EXPECT_NEAR(view.normals[v * kWidth + u].w, 2.5, 0.002) << "pixel " << u << ", " << v;
}

TEST_F(Raycast, AnEmptyVolumeShowsTheBackground) {
  SurfaceScene empty(device, {});
  const View view = cast(device, empty, Eigen::Isometry3d::Identity());
  EXPECT_EQ(view.hits(), 0u);
  for (const std::uint32_t pixel : view.preview) EXPECT_EQ(pixel >> 24, 255u);
}

int channel(std::uint32_t pixel, int i) {
  return int(pixel >> (8 * i) & 255);
}

/// Largest difference of the preview from a headlight on `surface` colours (0 .. 1), in steps of 1/255.
double shadingError(const View& view, const Eigen::Isometry3d& pose,
                    const std::function<Vector3d(const Vector3d&)>& surface) {
  double worst = 0;
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const glm::vec4 v = view.vertices[pixel], n = view.normals[pixel];
    if (v.w == 0) continue;
    const Vector3d normal(n.x, n.y, n.z), colour = surface(Vector3d(v.x, v.y, v.z));
    if (colour.x() < 0) continue;
    const double facing = std::max(0.0, -normal.dot(rayThrough(pose, pixel).first));
    for (int i = 0; i < 3; ++i) {
      const double expected = colour[i] * (0.2 + 0.7 * facing) + 0.1 * std::pow(facing, 24);
      worst = std::max(worst, std::abs(255 * expected - channel(view.preview[pixel], i)));
    }
  }
  return worst;
}

TEST_F(Raycast, PreviewIsLitFromTheCamera) {
  const auto pose = lookAt({0.9, 0.5, -1.1}, {0, 0, 0});
  const View view = cast(device, scene(), pose);
  EXPECT_LT(shadingError(view, pose, [](const Vector3d&) { return Vector3d(0.80, 0.78, 0.74); }), 1.0);
  EXPECT_GT(shadingError(view, pose, [](const Vector3d&) { return Vector3d(0.75, 0.78, 0.74); }), 5.0);
}

TEST_F(Raycast, PreviewTakesTheVolumesColours) {
  const auto pose = lookAt({0.9, 0.5, -1.1}, {0, 0, 0});
  const View view = cast(device, scene(true), pose);
  const auto truth = [](const Vector3d& p) -> Vector3d {
    // Beside the outline of the sphere the images' pixels and the voxels disagree; nothing is expected there.
    const bool sphere = p.norm() < kSphereRadius + 0.01;
    const std::uint32_t c = sphere ? kSphereColour : kBoxColour;
    return Vector3d(channel(c, 0), channel(c, 1), channel(c, 2)) / 255;
  };
  // Two colours are averaged and rounded to 8 bits in every fusion.
  EXPECT_LT(shadingError(view, pose, truth), 3.0);
}

}  // namespace test_raycast
}  // namespace rosefusion::testing
