// The example renderer: its triangles and the live model hide each other as their depths say, pixel by pixel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/renderer/compositor.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_renderer {

constexpr std::array<float, 3> kMagenta = {1, 0, 1};  // no colour of the model, nor of its backdrop
constexpr std::uint32_t kMagentaTexel = 0xFFFF00FF;

bool isMagenta(std::uint32_t texel) {
  return texel == kMagentaTexel;
}

/// Two triangles that fill the view, in a plane at depth z / (1 + tilt x) along the ray (x, y, 1).
std::vector<renderer::Vertex> wall(float z, float tilt) {
  const auto at = [&](float x, float y) {
    const float depth = z / (1 + tilt * x);
    return renderer::Vertex{{x * depth, y * depth, depth}, kMagenta};
  };
  return {at(-2, -2), at(2, -2), at(-2, 2), at(2, -2), at(2, 2), at(-2, 2)};
}

class Renderer : public ::testing::Test {
 protected:
  Renderer() { reconstructor.process(publicFrame(0)); }
  void TearDown() override { EXPECT_THAT(application.messages(), ::testing::IsEmpty()); }

  std::vector<std::uint32_t> draw(const std::vector<renderer::Vertex>& triangles) {
    renderer::Compositor compositor(application, reconstructor, publicCamera(), triangles);
    compositor.draw(application.beginFrame(), kIdentity);
    application.endFrame();
    application.waitForFrame();
    const std::size_t pixels = std::size_t(publicCamera().width) * publicCamera().height;
    return {compositor.read(), compositor.read() + pixels};
  }
  double magentaShare(const std::vector<renderer::Vertex>& triangles) {
    const auto picture = draw(triangles);
    return double(std::count_if(picture.begin(), picture.end(), isMagenta)) / double(picture.size());
  }

  renderer::Application application{{.validation = true, .instance_extensions = {}}};
  Reconstructor reconstructor{publicCamera(), application.handles(), quickOptions()};
};

TEST_F(Renderer, WhatIsNearerHidesTheRest) {
  EXPECT_EQ(magentaShare(wall(0.1f, 0)), 1) << "a wall before everything";
  const double beyond = magentaShare(wall(20, 0));
  EXPECT_LT(beyond, 0.5) << "a wall behind everything shows only where there is no model";
  EXPECT_GT(magentaShare(wall(0.5f, 0)), beyond);
  EXPECT_EQ(magentaShare(wall(0.02f, 0)), 0) << "nearer than the near plane nothing is drawn";
}

TEST_F(Renderer, TiltedWallCutsTheModelAtEqualDepth) {
  // The depth image that was fused says where the model is; the wall goes through the middle of it.
  const cv::Mat& depth = shortSequence().frames[0].depth;
  std::vector<double> depths;
  for (int i = 0; i < static_cast<int>(depth.total()); ++i)
    if (depth.ptr<std::uint16_t>()[i])
      depths.push_back(depth.ptr<std::uint16_t>()[i] / shortSequence().depth_units_per_metre);
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  const double middle = depths[depths.size() / 2];
  constexpr float kTilt = -0.3f;
  const auto picture = draw(wall(static_cast<float>(middle), kTilt)), beyond = draw(wall(20, 0));
  const Camera camera = publicCamera();
  std::size_t compared = 0, wrong = 0, hidden = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const double model = depth.at<std::uint16_t>(v, u) / shortSequence().depth_units_per_metre;
      const double tilted = middle / (1 + kTilt * (u - camera.cx) / camera.fx);
      const std::size_t i = std::size_t(v) * camera.width + u;
      // Noise and voxels; and no surface is where one frame saw too little of it.
      if (model == 0 || std::abs(model - tilted) < 0.1 || isMagenta(beyond[i])) continue;
      const bool wall_nearer = tilted < model;
      ++compared;
      hidden += !wall_nearer;
      wrong += isMagenta(picture[i]) != wall_nearer;
    }
  EXPECT_GT(compared, picture.size() / 2);
  EXPECT_GT(hidden, compared / 10);
  EXPECT_LT(hidden, compared * 9 / 10) << "the wall must cut the model, or this shows nothing";
  EXPECT_LT(wrong, compared / 50);
}

TEST_F(Renderer, DrawsWhileFramesAreTracked) {
  renderer::Compositor compositor(application, reconstructor, publicCamera(), wall(20, 0));
  for (std::size_t i = 1; i < 4; ++i) ASSERT_TRUE(reconstructor.push(publicFrame(i)));
  for (int frame = 0; frame < 5; ++frame) {
    compositor.draw(application.beginFrame(), kIdentity);
    application.endFrame();
  }
  reconstructor.wait();
  EXPECT_EQ(reconstructor.trajectory().size(), 4u);
}

}  // namespace test_renderer
}  // namespace rosefusion::testing
