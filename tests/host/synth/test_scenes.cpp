// Desks and objects, and the cameras that go around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "host/core/error.h"
#include "host/synth/sequence.h"
#include "tests/host/synth/small_options.h"

namespace rosefusion::testing {
namespace test_scenes {

SynthOptions around(SceneKind scene, std::uint64_t seed, int frames) {
  SynthOptions options = smallOptions(seed, frames);
  options.scene = scene;
  options.motion = Motion::Around;
  options.linear = {0.15, 0.5, 0.9};
  return options;
}

TEST(Scenes, DesksAreSeenFromWithinReach) {
  for (int seed = 1; seed <= 8; ++seed) {
    const SynthPlan plan(around(SceneKind::Desk, seed, 150));
    EXPECT_GT(plan.statistics().clearance, 0.14) << seed;
    EXPECT_LT(plan.statistics().linear_max, 0.9) << seed;
    EXPECT_GT(plan.statistics().linear_mean, 0.3) << seed;
    for (std::size_t i = 0; i < 150; i += 30) {
      const Pose& pose = plan.truth()[i].world_from_camera;
      const auto hit = plan.tracer().cast(pose.translation(), pose.linear().col(2), 10);
      ASSERT_TRUE(hit);
      EXPECT_GT(hit->distance, 0.2) << seed << ' ' << i;
      EXPECT_LT(hit->distance, 1.3) << seed << ' ' << i;
    }
  }
}

TEST(Scenes, DesksAsFastAsAsked) {
  for (const double high : {0.3, 1.2}) {
    SynthOptions options = around(SceneKind::Desk, 2, 150);
    options.linear = options.linear.endingAt(high);
    const double fastest = SynthPlan(options).statistics().linear_max;
    EXPECT_GT(fastest, 0.7 * high);
    EXPECT_LT(fastest, high);
  }
}

TEST(Scenes, ObjectsHaveTheirSizeAndATurnCloses) {
  for (int seed = 1; seed <= 8; ++seed) {
    const SynthPlan plan(around(SceneKind::Object, seed, 145));
    const Scene& scene = plan.scene();
    Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9f), high = -low;
    for (std::uint32_t t = scene.subject.first_triangle; t < scene.subject.end_triangle; ++t)
      for (const std::uint32_t v : scene.mesh.triangles[t]) {
        low = low.cwiseMin(scene.mesh.vertices[v]);
        high = high.cwiseMax(scene.mesh.vertices[v]);
      }
    EXPECT_GT((high - low).maxCoeff(), 0.18f) << seed;
    EXPECT_LT((high - low).maxCoeff(), 0.65f) << seed;
    const Pose &first = plan.truth().front().world_from_camera, &last = plan.truth().back().world_from_camera;
    EXPECT_TRUE(areNear(first, last, 1e-6, 1e-6)) << seed;
    EXPECT_FALSE(areNear(first, plan.truth()[72].world_from_camera, 0.5, 1)) << seed;
    for (std::size_t i = 1; i < plan.truth().size(); ++i) {
      const double turn =
          rotationAngle(plan.truth()[i - 1].world_from_camera.inverse() * plan.truth()[i].world_from_camera);
      EXPECT_NEAR(turn * 180 / 3.14159, 2.5, 0.9) << seed << ' ' << i;
    }
  }
}

TEST(Scenes, ObjectsAsFastAsAsked) {
  SynthOptions options = around(SceneKind::Object, 2, 200);
  options.turn_per_frame = 0;
  const MotionStatistics statistics = SynthPlan(options).statistics();
  EXPECT_NEAR(statistics.linear_mean, 0.5, 0.05);
  EXPECT_LT(statistics.linear_max, 0.92);
}

TEST(Scenes, CutOutKeepsTheObjectAlone) {
  SynthOptions options = around(SceneKind::Object, 3, 30);
  options.noise = DepthNoise::None;
  const SynthPlan whole(options);
  options.cut_out = true;
  const SynthPlan cut(options);
  const cv::Mat all = whole.renderFrame(10).depth, some = cut.renderFrame(10).depth;
  const double share = double(cv::countNonZero(some)) / double(some.total());
  EXPECT_GT(share, 0.01);
  EXPECT_LT(share, 0.6);
  EXPECT_GT(cv::countNonZero(all), 2 * cv::countNonZero(some));
  const Subject& object = cut.scene().subject;
  for (int v = 0; v < some.rows; ++v)
    for (int u = 0; u < some.cols; ++u) {
      const std::uint16_t z = some.at<std::uint16_t>(v, u);
      if (z == 0) continue;
      EXPECT_EQ(z, all.at<std::uint16_t>(v, u));
      const Eigen::Vector3d p = cut.truth()[10].world_from_camera *
                                options.intrinsics.unproject(u, v, z / kSynthDepthUnitsPerMetre);
      EXPECT_LT((p - object.centre).norm(), 1.3 * object.half.norm());
    }
}

TEST(Scenes, WhatContradictsIsRefused) {
  SynthOptions options = around(SceneKind::Desk, 1, 5);
  options.cut_out = true;
  EXPECT_THROW(requirePlausible(options), InputError);
  options.cut_out = false;
  options.motion = Motion::SixDof;
  EXPECT_THROW(requirePlausible(options), InputError);
  options = smallOptions();
  options.cut_out = true;
  EXPECT_THROW(requirePlausible(options), InputError);
}

}  // namespace test_scenes
}  // namespace rosefusion::testing
