// Passes recorded into an application's own command buffers do what they do when the engine submits them.
#include <bit>

#include "engine/passes/raycast.h"
#include "tests/engine/caller.h"
#include "tests/engine/surface_scene.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_caller_commands {

constexpr std::uint32_t kWidth = 80, kHeight = 60;
constexpr float kNothing = 1e9f;

class CallerCommands : public ::testing::Test {
 protected:
  CallerCommands() { fuse(0); }
  void TearDown() override { EXPECT_THAT(caller.messages(), ::testing::IsEmpty()); }

  void fuse(std::size_t pose) { scene.fuse(posesAllAround()[pose]); }
  RaycastView view() const {
    RaycastView out;
    out.world_from_camera = toGlm(posesAllAround()[0]);
    out.clear = true;
    out.depth_value = glm::vec4(0, 0, 1, kNothing);
    return out;
  }
  shader::CameraIntrinsics camera{glm::vec4(60, 60, 39.5f, 29.5f), glm::ivec4(kWidth, kHeight, 0, 0)};

  Caller caller;
  Device device{caller.handles()};
  SurfaceScene scene{device, {.voxel_size = 0.04f}};
};

TEST_F(CallerCommands, RaycastFillsTheCallersImages) {
  const VkImage picture =
      caller.makeImage(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight);
  const VkImage depth = caller.makeImage(VK_FORMAT_R32_SFLOAT, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight);
  RaycastPass pass(device, camera, Memory::Device), other(device, camera);
  Recorder recorder(device);
  caller.frame([&](VkCommandBuffer commands) {
    recorder.recordInto(commands);
    pass.record(recorder, scene.volume, view());
    recorder.copyToImage(pass.picture(), picture, ImageAspect::Colour, kWidth, kHeight);
    recorder.copyToImage(pass.depth(), depth, ImageAspect::Colour, kWidth, kHeight);
  });
  recorder.recordInto(nullptr);
  other.record(recorder, scene.volume, view());
  recorder.submit();

  const auto texels = caller.read(picture, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight);
  const auto depths = caller.read(depth, VK_IMAGE_ASPECT_COLOR_BIT, kWidth, kHeight);
  EXPECT_TRUE(std::equal(texels.begin(), texels.end(), other.preview().begin()));
  const auto surface = download<std::uint32_t>(device, other.surface());
  std::size_t hits = 0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const float z = std::bit_cast<float>(depths[i]);
    const float expected = std::bit_cast<float>(surface[2 * i + 1]);
    if (expected == 0) {
      EXPECT_EQ(z, kNothing);
      EXPECT_EQ(texels[i], 0u) << "transparent where nothing is";
      continue;
    }
    ++hits;
    EXPECT_NEAR(z, expected, 1e-6);
    EXPECT_EQ(texels[i] >> 24, 255u);
  }
  EXPECT_GT(hits, texels.size() / 2);
}

TEST_F(CallerCommands, DepthCanBeThatOfAProjection) {
  RaycastPass metres(device, camera), projected(device, camera);
  RaycastView view = this->view();
  metres.record(scene.recorder, scene.volume, view);
  constexpr float kNear = 0.1f, kFar = 10;  // z / w of Vulkan's usual projection
  view.depth_value = glm::vec4(kFar / (kFar - kNear), -kFar * kNear / (kFar - kNear), 0, 1);
  projected.record(scene.recorder, scene.volume, view);
  scene.recorder.submit();
  const auto z = download<float>(device, metres.depth()), d = download<float>(device, projected.depth());
  for (std::size_t i = 0; i < z.size(); ++i)
    EXPECT_NEAR(d[i], z[i] == kNothing ? 1 : kFar / (kFar - kNear) * (1 - kNear / z[i]), 1e-5);
}

TEST_F(CallerCommands, WhatWasRecordedSurvivesTheVolumesGrowth) {
  SurfaceScene fine(device, {});
  const auto poses = posesAllAround();
  fine.fuse(poses[0]);
  RaycastPass before(device, camera), recorded(device, camera);
  before.record(fine.recorder, fine.volume, view());
  fine.recorder.submit();
  Recorder recorder(device);
  const void* pool = fine.volume.tsdf()[0].handle();
  const VkCommandBuffer commands = caller.beginFrame();
  recorder.recordInto(commands);
  recorded.record(recorder, fine.volume.view(), view());
  for (std::size_t pose = poses.size() - 1; pose > 0 && fine.volume.tsdf()[0].handle() == pool; --pose)
    fine.fuse(poses[pose]);
  EXPECT_NE(fine.volume.tsdf()[0].handle(), pool) << "the volume must grow, or this shows nothing";
  caller.endFrame(commands);
  const auto expected = download<float>(device, before.depth()),
             found = download<float>(device, recorded.depth());
  std::size_t same = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) same += std::abs(expected[i] - found[i]) < 0.02f;
  // What was fused before the pools were replaced shows too, and shifts the surface a little.
  EXPECT_GT(same, 0.95 * expected.size());
}

TEST_F(CallerCommands, TheEngineDoesNotSubmitForTheCaller) {
  Recorder recorder(device);
  caller.frame([&](VkCommandBuffer commands) {
    recorder.recordInto(commands);
    EXPECT_TRUE(throwsDeviceError([&] { recorder.submit(); }, DeviceErrorCode::Programming,
                                  {"submitted by the caller"}));
  });
}

}  // namespace test_caller_commands
}  // namespace rosefusion::testing
