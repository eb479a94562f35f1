// The volume: growth, pool chunks, limits, and that none of them changes what was fused.
#include <algorithm>
#include <cmath>

#include "engine/caller_device.h"
#include "engine/passes/fitness.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_volume {

constexpr VolumeOptions kOptions{.voxel_size = 0.02f, .truncation = 0.06f, .colour = true};
constexpr std::uint64_t kColourBlockBytes = 4 * shader::kBlockColourWords;  // the largest of the three pools

VolumeOptions withPools(std::uint64_t blocks) {
  VolumeOptions options = kOptions;
  options.max_pool_bytes = blocks * kColourBlockBytes;
  return options;
}

bool startsWith(const VolumeContents& later, const VolumeContents& earlier) {
  return std::equal(earlier.blocks.begin(), earlier.blocks.end(), later.blocks.begin()) &&
         std::equal(earlier.tsdf.begin(), earlier.tsdf.end(), later.tsdf.begin()) &&
         std::equal(earlier.weight.begin(), earlier.weight.end(), later.weight.begin()) &&
         std::equal(earlier.colour.begin(), earlier.colour.end(), later.colour.begin());
}

bool same(const VolumeContents& a, const VolumeContents& b) {
  return a.blocks.size() == b.blocks.size() && startsWith(a, b);
}

/// The page table on the device, and where each block should be in it.
void expectTableMatches(Device& device, const Volume& volume) {
  const auto layout = readBack<shader::VolumeLayout>(device, volume.layoutBuffer(), 1)[0];
  const glm::ivec4 size = layout.table_size, origin = layout.table_origin;
  const auto table = readBack<std::uint32_t>(device, volume.table(), std::size_t(size.x) * size.y * size.z);
  const auto coordinates = readBack<glm::ivec4>(device, volume.blockBuffer(), volume.blocks().size());
  std::size_t present = 0;
  for (const std::uint32_t slot : table) present += slot != 0;
  EXPECT_EQ(present, volume.blockCount());
  for (std::uint32_t slot = 1; slot < volume.blocks().size(); ++slot) {
    const glm::ivec4 entry = volume.blocks()[slot] - origin;
    ASSERT_EQ(table[(std::size_t(entry.z) * size.y + entry.y) * size.x + entry.x], slot);
    ASSERT_EQ(glm::ivec3(coordinates[slot]), glm::ivec3(volume.blocks()[slot]));
  }
}

class Volumes : public ValidatingDevice {
 protected:
  std::vector<float> losses(SceneRun& run) {
    std::vector<glm::vec4> templates;
    for (int i = 0; i < 64; ++i) {
      templates.emplace_back(std::sin(i), std::sin(2 * i), std::sin(3 * i), 0);
      templates.emplace_back(std::sin(5 * i), std::sin(7 * i), std::sin(11 * i), 0);
    }
    SelectPointsPass points(device(), onDevice(run.sequence.camera));
    FitnessPass fitness(device(), templates, Loss::Squared, true, 2);
    points.record(run.recorder, run.preprocess.frame(), {4, 1, 1}, nullptr);
    fitness.record(run.recorder, run.volume, points,
                   {onDevice(run.sequence.poses.back()), glm::vec4(0.05f), glm::vec4(0.05f), 0, 64});
    run.recorder.submit();
    return {fitness.losses().begin(), fitness.losses().end()};
  }
};

TEST_F(Volumes, StartEmptyAndUnobserved) {
  Volume volume(device(), kOptions);
  EXPECT_EQ(volume.blockCount(), 0u);
  const VolumeContents contents = volume.download();
  EXPECT_EQ(contents.blocks.size(), 1u);
  EXPECT_THAT(contents.tsdf, ::testing::Each(1.0f));
  EXPECT_THAT(contents.weight, ::testing::Each(0.0f));
  EXPECT_THAT(contents.colour, ::testing::Each(0u));
}

TEST_F(Volumes, GrowthKeepsWhatWasFused) {
  // Pools for 4096 blocks at first; the frames ask for more, and look around so that the table moves on all
  // sides.
  Sequence sequence = makeSequence(kPlainCamera, 4, 61);
  for (int i = 0; i < 4; ++i) {
    sequence.poses[i] = Pose(Eigen::AngleAxisd(1.57 * i, Eigen::Vector3d::UnitY())) * sequence.poses[i];
    sequence.images[i] = render(reference::makeScene(61), kPlainCamera, sequence.poses[i], 5000, 0.03, i);
  }
  VolumeOptions options = kOptions;
  options.voxel_size = 0.01f;
  SceneRun run(device(), sequence, options);
  int grown = 0;
  for (int i = 0; i < 4; ++i) {
    const VolumeContents before = run.volume.download();
    const std::uint64_t bytes = run.volume.memoryBytes();
    run.load(i);
    run.allocateBlocks(sequence.poses[i]);
    grown += run.volume.memoryBytes() > bytes + (8u << 20);
    const VolumeContents after = run.volume.download();
    EXPECT_GE(after.blocks.size(), before.blocks.size());
    EXPECT_TRUE(startsWith(after, before)) << "frame " << i;
    EXPECT_TRUE(std::all_of(after.tsdf.begin() + before.tsdf.size(), after.tsdf.end(),
                            [](float t) { return t == 1; }));
    EXPECT_TRUE(std::all_of(after.weight.begin() + before.weight.size(), after.weight.end(),
                            [](float w) { return w == 0; }));
    expectTableMatches(device(), run.volume);
    run.integrateDepth(sequence.poses[i]);
    EXPECT_FALSE(startsWith(run.volume.download(), after)) << "frame " << i << " fused nothing";
  }
  EXPECT_GT(run.volume.blockCount(), 6000u);
  EXPECT_GE(grown, 2);
}

TEST_F(Volumes, AnyNumberOfPoolChunksHoldsTheSame) {
  const Sequence sequence = makeSequence(kPlainCamera, 3, 62);
  SceneRun one(device(), sequence, kOptions);
  one.fuseAll();
  const std::uint32_t blocks = one.volume.blockCount() + 1;
  ASSERT_EQ(one.volume.chunks(), 1u);
  // Pools hold powers of two: enough blocks for two chunks of 512 and four of 256, with a last one that is
  // not full.
  ASSERT_GT(blocks, 3 * 256u);
  ASSERT_LT(blocks, 4 * 256u);
  const VolumeContents expected = one.volume.download();
  const std::vector<float> expected_losses = losses(one);
  for (const std::uint32_t chunk_blocks : {512u, 256u}) {
    SCOPED_TRACE(std::to_string(chunk_blocks) + " blocks per pool");
    SceneRun many(device(), sequence, withPools(chunk_blocks + 3));  // rounded down
    many.fuseAll();
    EXPECT_EQ(many.volume.chunks(), (blocks + chunk_blocks - 1) / chunk_blocks);
    EXPECT_TRUE(same(many.volume.download(), expected));
    EXPECT_EQ(losses(many), expected_losses);
  }
  // And three: the first frame alone.
  Sequence shorter = sequence;
  shorter.images.resize(1);
  shorter.poses.resize(1);
  SceneRun single(device(), shorter, kOptions), three(device(), shorter, withPools(256));
  for (SceneRun* run : {&single, &three}) run->fuseAll();
  EXPECT_EQ(three.volume.chunks(), 3u);
  EXPECT_TRUE(same(three.volume.download(), single.volume.download()));
  EXPECT_EQ(losses(three), losses(single));
}

TEST_F(Volumes, ClearedTheyAreAsNew) {
  for (const VolumeOptions& options : {kOptions, withPools(256)}) {
    SceneRun run(device(), makeSequence(kPlainCamera, 2, 66), options);
    run.fuseAll();
    const std::uint32_t blocks = run.volume.blockCount();
    const std::uint64_t bytes = run.volume.memoryBytes();
    const std::vector<float> expected = losses(run);
    run.volume.clear();
    EXPECT_EQ(run.volume.blockCount(), 0u);
    EXPECT_EQ(run.volume.download().blocks.size(), 1u);
    expectTableMatches(device(), run.volume);
    EXPECT_NE(losses(run), expected);
    run.fuseAll();
    EXPECT_EQ(run.volume.blockCount(), blocks);
    EXPECT_EQ(run.volume.memoryBytes(), bytes);
    expectTableMatches(device(), run.volume);
    EXPECT_EQ(losses(run), expected) << "nothing of what was fused before is left";
  }
}

TEST_F(Volumes, ChunksComparisonSeesADifference) {
  SceneRun run(device(), makeSequence(kPlainCamera, 1, 62), kOptions);
  run.fuseAll();
  const VolumeContents before = run.volume.download();
  const auto before_losses = losses(run);
  run.integrateDepth(run.sequence.poses[0]);
  EXPECT_FALSE(same(run.volume.download(), before));
  run.integrateDepth(run.sequence.poses[0] * Pose(Eigen::Translation3d(0.003, 0, 0)));
  EXPECT_NE(losses(run), before_losses);
}

/// Fuses a first frame, makes the growth for a second one fail in the way of `options`, and expects the
/// volume to be as it was, and usable.
void expectUnharmed(Device& device, const VolumeOptions& options,
                    std::initializer_list<const char*> sentence) {
  Sequence sequence = makeSequence(kPlainCamera, 2, 63);
  sequence.poses[1] = Pose(Eigen::AngleAxisd(3, Eigen::Vector3d::UnitY()));
  for (int i = 0; i < 160 * 120; ++i)
    if (i % 160 < 80) sequence.images[0].depth[i] = 0;  // the first frame needs less than the second
  sequence.images[1] = render(reference::makeScene(63), kPlainCamera, sequence.poses[1], 5000, 0.03, 1);
  SceneRun run(device, sequence, options);
  run.fuse(0);
  const VolumeContents before = run.volume.download();
  const std::uint64_t device_bytes = device.allocatedBytes();
  run.load(1);
  EXPECT_TRUE(throwsDeviceError([&] { run.allocateBlocks(sequence.poses[1]); }, DeviceErrorCode::OutOfMemory,
                                sentence));
  EXPECT_TRUE(same(run.volume.download(), before));
  expectTableMatches(device, run.volume);
  if (options.memory_limit_bytes > 0) {
    EXPECT_LE(run.volume.memoryBytes(), options.memory_limit_bytes);
  }
  EXPECT_LE(device.allocatedBytes(), device_bytes + (2u << 20));  // staging may stay
  // The next frame of the known part goes in as if nothing had happened.
  run.load(0);
  run.allocateBlocks(sequence.poses[0]);
  run.integrateDepth(sequence.poses[0]);
  SceneRun fresh(device, sequence, kOptions);
  fresh.fuse(0);
  fresh.integrateDepth(sequence.poses[0]);
  EXPECT_TRUE(same(run.volume.download(), fresh.volume.download()));
}

TEST_F(Volumes, MemoryLimitLeavesThemAsTheyWere) {
  // The first 512 blocks take 2.1 MiB; the few that still fit are not enough.
  VolumeOptions options = withPools(512);
  options.memory_limit_bytes = 9u << 18;
  expectUnharmed(device(), options, {"2 MiB", "volume.voxel_size", "volume.memory_limit_mb"});
}

TEST_F(Volumes, RunningOutOfPoolsLeavesThemAsTheyWere) {
  expectUnharmed(device(), withPools(128), {"512 voxel blocks", "volume.voxel_size"});
}

TEST_F(Volumes, OfOneChunkWhereFewBuffersAreBound) {
  DeviceOptions options = deviceUnderTest();
  options.limits_at_most.max_storage_buffers = deviceRequirements().limits.max_storage_buffers;
  Device few(options);
  expectUnharmed(few, withPools(512), {"512 voxel blocks", "volume.voxel_size"});
  EXPECT_THAT(few.validationMessages(), ::testing::IsEmpty());
}

TEST_F(Volumes, TheLastRoomIsUsedBeforeALimitIsReached) {
  // Growing by half would need 6144 blocks of 2 KiB and 16 B; the limit allows 5000.
  VolumeOptions options{.voxel_size = 0.02f, .truncation = 0.06f};
  options.memory_limit_bytes = 5000 * (2048 + 16) + (1u << 20);
  Volume volume(device(), options);
  volume.cover({0, 0, 0}, {20, 20, 20});
  const auto layout = readBack<shader::VolumeLayout>(device(), volume.layoutBuffer(), 1)[0];
  const auto rows = [&](int from, int to) {
    std::vector<std::uint32_t> entries;
    for (int i = from; i < to; ++i)
      entries.push_back((std::uint32_t(i / 400 + 2) * layout.table_size.y + i / 20 % 20 + 2) *
                            layout.table_size.x +
                        i % 20 + 2);
    return entries;
  };
  Recorder recorder(device());
  const auto add = [&](std::vector<std::uint32_t> entries) {
    volume.addBlocks(recorder, std::move(entries));
    recorder.submit();
  };
  add(rows(0, 4090));
  add(rows(4090, 4600));
  EXPECT_EQ(volume.blockCount(), 4600u);
  EXPECT_LE(volume.memoryBytes(), options.memory_limit_bytes);
  EXPECT_TRUE(throwsDeviceError([&] { add(rows(4600, 5600)); }, DeviceErrorCode::OutOfMemory, {"limit"}));
  EXPECT_EQ(volume.blockCount(), 4600u);
  expectTableMatches(device(), volume);
}

TEST_F(Volumes, AnAbsurdExtentIsRefused) {
  SceneRun run(device(), makeSequence(kPlainCamera, 1, 64), kOptions);
  run.fuse(0);
  const VolumeContents before = run.volume.download();
  for (const double metres : {500.0, 1e6, 1e12, std::nan("")}) {
    Pose pose = Pose::Identity();
    pose.translation().setConstant(metres);
    EXPECT_TRUE(throwsDeviceError([&] { run.allocateBlocks(pose); }, DeviceErrorCode::OutOfMemory,
                                  {"extent", "volume.voxel_size"}))
        << metres;
    EXPECT_TRUE(same(run.volume.download(), before)) << metres;
    expectTableMatches(device(), run.volume);
  }
}

TEST_F(Volumes, ALimitBelowTheFirstPoolsIsRefusedAtOnce) {
  const std::uint64_t start = device().allocatedBytes();
  VolumeOptions options = kOptions;
  options.memory_limit_bytes = 1000;
  EXPECT_TRUE(throwsDeviceError([&] { Volume(device(), options); }, DeviceErrorCode::OutOfMemory,
                                {"volume.voxel_size"}));
  EXPECT_EQ(device().allocatedBytes(), start);
}

TEST_F(Volumes, OptionsOutOfRangeAreProgrammingErrors) {
  const VolumeOptions wrong[] = {{.voxel_size = 0},      {.voxel_size = -0.01f},   {.voxel_size = NAN},
                                 {.truncation = 0},      {.truncation = INFINITY}, {.max_weight = 0.5f},
                                 {.max_weight = 255.5f}, {.max_weight = NAN},      {.max_pool_bytes = 2047}};
  for (const VolumeOptions& options : wrong)
    EXPECT_TRUE(
        throwsDeviceError([&] { Volume(device(), options); }, DeviceErrorCode::Programming, {"range"}));
}

TEST_F(Volumes, TheLargestWeightIsKept) {
  VolumeOptions options = kOptions;
  options.max_weight = 255;
  options.voxel_size = 0.08f;
  SceneRun run(device(), makeSequence(kPlainCamera, 1, 65), options);
  run.fuse(0);
  for (int i = 0; i < 299; ++i) run.integrateDepth(run.sequence.poses[0]);
  const VolumeContents contents = run.volume.download();
  EXPECT_EQ(*std::max_element(contents.weight.begin(), contents.weight.end()), 255.0f);
  for (const float weight : contents.weight) ASSERT_TRUE(weight == 0 || weight == 255);
}

TEST_F(Volumes, MemoryIsGivenBack) {
  const std::uint64_t start = device().allocatedBytes();
  {
    SceneRun run(device(), makeSequence(kPlainCamera, 1, 66), kOptions);
    run.fuseAll();
    EXPECT_GE(device().allocatedBytes(), start + run.volume.memoryBytes());
  }
  EXPECT_EQ(device().allocatedBytes(), start);
}

}  // namespace test_volume
}  // namespace rosefusion::testing
