// Where a camera of known rotation stands, from the offsets of planes, in a room of patches.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "host/slam/relocalisation/plane_alignment.h"

namespace rosefusion::testing {
namespace test_plane_alignment {

/// Patches every 15 cm of a rectangle from `corner` along two sides.
void addRectangle(std::vector<SurfacePatch>& patches, const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                  const Eigen::Vector3d& b) {
  constexpr double kApart = 0.15;
  for (double s = kApart / 2; s < a.norm(); s += kApart)
    for (double t = kApart / 2; t < b.norm(); t += kApart)
      patches.push_back({corner + s * a.normalized() + t * b.normalized(), a.cross(b).normalized()});
}

/// A room of 6 x 4 x 2.5 m, z up, with a table's top and a cupboard; normals inwards.
std::vector<SurfacePatch> room() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  std::vector<SurfacePatch> patches;
  addRectangle(patches, {0, 0, 0}, 6 * x, 4 * y);
  addRectangle(patches, {0, 0, 0}, 4 * y, 2.5 * z);
  addRectangle(patches, {6, 0, 0}, 2.5 * z, 4 * y);
  addRectangle(patches, {0, 0, 0}, 2.5 * z, 6 * x);
  addRectangle(patches, {0, 4, 0}, 6 * x, 2.5 * z);
  addRectangle(patches, {4, 1, 0.7}, 1.2 * x, 0.8 * y);
  addRectangle(patches, {0.6, 1.5, 0}, 1 * y, 1.8 * z);
  return patches;
}

/// What a camera with 80 degrees of view shows of it within 5 m, walls being no obstacle, 1 cm of noise.
std::vector<SurfacePatch> look(const std::vector<SurfacePatch>& model, const Pose& world_from_camera) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  const Pose camera_from_world = world_from_camera.inverse();
  std::vector<SurfacePatch> view;
  for (const SurfacePatch& patch : model) {
    const Eigen::Vector3d p = camera_from_world * patch.point, n = camera_from_world.linear() * patch.normal;
    if (p.z() < 0.4 || p.norm() > 5 || std::hypot(p.x(), p.y()) > 0.84 * p.z() || n.dot(p) >= 0) continue;
    view.push_back({p + n * noise(random), n});
  }
  return view;
}

Pose lookingAlong(const Eigen::Vector3d& from, double yaw, double down) {
  const Eigen::Vector3d forward(std::cos(yaw) * std::cos(down), std::sin(yaw) * std::cos(down),
                                -std::sin(down));
  Pose pose = Pose::Identity();
  pose.translation() = from;
  pose.linear().col(2) = forward;
  pose.linear().col(0) = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear().col(1) = pose.linear().col(2).cross(pose.linear().col(0));
  return pose;
}

/// The rotation and the same by quarters of a turn about the vertical.
std::vector<Eigen::Matrix3d> quarters(const Eigen::Matrix3d& rotation) {
  std::vector<Eigen::Matrix3d> out;
  for (int k = 3; k >= 0; --k)
    out.push_back(Eigen::AngleAxisd(k * M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix() * rotation);
  return out;
}

std::size_t rankOf(const Pose& truth, const std::vector<PoseHypothesis>& poses, double within) {
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (areNear(poses[i].world_from_camera, truth, within, 0.01)) return i;
  return poses.size();
}

TEST(PlaneAlignment, FindsARoomsCornerWithoutAGuess) {
  const auto model = room();
  for (const double yaw : {0.6, 2.2, 3.8, 5.4}) {
    const Pose camera = lookingAlong({2.7, 2.1, 1.4}, yaw, 0.4);
    const auto poses = poseHypotheses(look(model, camera), model, quarters(camera.linear()), 200);
    ASSERT_FALSE(poses.empty());
    EXPECT_LT(rankOf(camera, poses, 0.12), 10U) << "yaw " << yaw;
    EXPECT_GT(poses.front().met, 0.9);
    EXPECT_TRUE(std::is_sorted(poses.begin(), poses.end(),
                               [](const auto& a, const auto& b) { return a.met > b.met; }));
  }
}

TEST(PlaneAlignment, HalfOfTheViewMayBeUnknown) {
  const auto all = room();
  std::vector<SurfacePatch> model;
  for (const SurfacePatch& patch : all)
    if (patch.point.x() > 4) model.push_back(patch);
  const Pose camera = lookingAlong({2.5, 2.9, 1.5}, -0.9, 0.35);
  const auto view = look(all, camera);
  ASSERT_LT(static_cast<double>(look(model, camera).size()), 0.7 * static_cast<double>(view.size()));
  EXPECT_LT(rankOf(camera, poseHypotheses(view, model, quarters(camera.linear()), 1000), 0.15), 1000U);
}

TEST(PlaneAlignment, AnOpenDirectionIsTriedAllAlong) {
  std::vector<SurfacePatch> corridor;
  addRectangle(corridor, {0, 0, 0}, {12, 0, 0}, {0, 2, 0});
  addRectangle(corridor, {0, 2, 0}, {12, 0, 0}, {0, 0, 2.5});
  const Pose camera = lookingAlong({5, 0.5, 1.2}, M_PI / 2, 0.5);
  const std::vector<Eigen::Matrix3d> rotations{camera.linear()};
  const auto poses = poseHypotheses(look(corridor, camera), corridor, rotations, 100);
  double least = 12, most = 0;
  for (const PoseHypothesis& pose : poses) {
    if (pose.met < 0.9) continue;
    EXPECT_NEAR(pose.world_from_camera.translation().y(), 0.5, 0.1);
    EXPECT_NEAR(pose.world_from_camera.translation().z(), 1.2, 0.1);
    least = std::min(least, pose.world_from_camera.translation().x());
    most = std::max(most, pose.world_from_camera.translation().x());
  }
  EXPECT_LT(least, 2.5);
  EXPECT_GT(most, 9.5);
}

TEST(PlaneAlignment, NothingSeenOrNothingKnownHasNoPlace) {
  const std::vector<Eigen::Matrix3d> rotations{Eigen::Matrix3d::Identity()};
  EXPECT_TRUE(poseHypotheses({}, room(), rotations, 10).empty());
  EXPECT_TRUE(poseHypotheses(room(), {}, rotations, 10).empty());
  std::vector<SurfacePatch> wall;
  addRectangle(wall, {0, 0, 2}, {0, 3, 0}, {3, 0, 0});
  EXPECT_TRUE(poseHypotheses(wall, room(), rotations, 10).empty()) << "one direction alone";
}

}  // namespace test_plane_alignment
}  // namespace rosefusion::testing
