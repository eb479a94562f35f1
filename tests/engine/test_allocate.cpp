// Pass allocate against the exact set of blocks that the truncation bands touch.
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/allocate.h"

namespace rosefusion::testing {
namespace test_allocate {

// Blocks of 8 cm: thousands of them, and still wider than two pixels are apart.
constexpr VolumeOptions kVolume{.voxel_size = 0.01f, .truncation = 0.06f};

reference::BandOptions bandOf(const VolumeOptions& options) {
  // One voxel more than the truncation, as the pass promises.
  return {.voxel_size = options.voxel_size, .half_length = double(options.truncation) + options.voxel_size};
}

class Allocate : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  reference::Comparison allocateAndCompare(const reference::BandOptions& band,
                                           const Pose& error = Pose::Identity()) {
    SceneRun run(device(), makeSequence(GetParam(), 2, 21), kVolume);
    reference::BandBlocks expected(band);
    for (int frame = 0; frame < 2; ++frame) {
      run.load(frame);
      run.allocateBlocks(run.sequence.poses[frame]);
      expected.add(run.referenceImage(frame), GetParam(), run.sequence.poses[frame] * error);
    }
    return compare(expected, blocksOf(run.volume));
  }
};

TEST_P(Allocate, AgreesWithTheReference) {
  const auto result = allocateAndCompare(bandOf(kVolume));
  EXPECT_TRUE(agrees(result));
  EXPECT_GT(result.compared, 2000u);
}

TEST_P(Allocate, ComparisonSeesAWrongCoefficient) {
  auto band = bandOf(kVolume);
  band.half_length *= 1.01;
  EXPECT_TRUE(differs(allocateAndCompare(band)));
  band.half_length = 0.99 * bandOf(kVolume).half_length;
  EXPECT_TRUE(differs(allocateAndCompare(band)));
  band = bandOf(kVolume);
  band.voxel_size *= 1.002;
  EXPECT_TRUE(differs(allocateAndCompare(band)));
  Pose error = Pose::Identity();
  error.translation().x() = 0.002;
  EXPECT_TRUE(differs(allocateAndCompare(bandOf(kVolume), error)));
}

TEST_P(Allocate, EveryPixelsSurfaceGetsABlock) {
  // Whatever the pass samples: a pixel that it skips must find its blocks through its neighbours. At depth
  // steps it may not, and the 3 % of invalid pixels leave a few more alone.
  constexpr double kAllowedMisses = 0.002;
  SceneRun run(device(), makeSequence(GetParam(), 1, 22), kVolume);
  run.load(0);
  run.allocateBlocks(run.sequence.poses[0]);
  const auto blocks = blocksOf(run.volume);
  const std::set<reference::Block> present(blocks.begin(), blocks.end());
  const auto image = run.referenceImage(0);
  std::size_t pixels = 0, missed = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    if (image.depth[i] <= 0) continue;
    const Eigen::Vector3d cell =
        (run.sequence.poses[0] * image.points[i] / (8 * kVolume.voxel_size)).array().floor();
    ++pixels;
    missed += !present.count({int(cell.x()), int(cell.y()), int(cell.z())});
  }
  EXPECT_GT(pixels, 15000u);
  EXPECT_LT(missed, kAllowedMisses * pixels);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Allocate, kBothCameras, cameraName);

class AllocateList : public ValidatingDevice {};

TEST_F(AllocateList, AFullListChangesNoSlot) {
  const Sequence sequence = makeSequence(kPlainCamera, 2, 23);
  SceneRun roomy(device(), sequence, kVolume), tight(device(), sequence, kVolume, 5);
  for (SceneRun* run : {&roomy, &tight}) run->fuseAll();
  ASSERT_GT(roomy.volume.blockCount(), 2000u);
  EXPECT_EQ(blocksOf(roomy.volume), blocksOf(tight.volume));
}

TEST_F(AllocateList, AnImageWithoutDepthAsksForNothing) {
  Sequence sequence = makeSequence(kPlainCamera, 1, 24);
  std::fill(sequence.images[0].depth.begin(), sequence.images[0].depth.end(), 0);
  SceneRun run(device(), sequence, kVolume);
  run.fuseAll();
  EXPECT_EQ(run.volume.blockCount(), 0u);
}

}  // namespace test_allocate
}  // namespace rosefusion::testing
