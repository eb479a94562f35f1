// Pass integrate against a double-precision TSDF without quantisation.
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_integrate {

// The cap is reached by most voxels within the 8 frames, so that both the mean and its capped form are
// compared.
constexpr VolumeOptions kVolume{.voxel_size = 0.04f, .truncation = 0.12f, .max_weight = 5, .colour = true};
constexpr int kFrames = 8;
// Voxels within rounding of the line between two pixels, added up over the frames.
constexpr double kSkippedShare = 0.02;

// Float values, so that both sides weigh by the same numbers. The depths, up to 4.5 m, weigh from 1 to 0.15,
// which leaves the weights' rounding small against them.
constexpr reference::DepthNoise kNoise{.floor = 0.005f, .growth = 0.0005f, .bias_growth = 0.0004f};

struct Wrong {
  double voxel_size = 1, truncation = 1, max_weight = 1, focal = 1, centre = 0, shift = 0, turn = 0;
  double floor = 1, growth = 1, bias_growth = 1, deviations = 1;
};

class Integrate : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    fuse({});
  }

  void fuse(const reference::DepthNoise& noise, const VolumeOptions& volume = kVolume) {
    Sequence sequence = makeSequence(GetParam(), kFrames, 31);
    sequence.sensor.noise = noise;
    run_.emplace(device(), sequence, volume);
    allocated_.clear();
    for (int i = 0; i < kFrames; ++i) {
      run_->fuse(i);
      allocated_.push_back(blocksOf(run_->volume));
    }
    contents_ = run_->volume.download();
  }

  reference::TsdfMap referenceMap(const Wrong& wrong = {}) const {
    reference::TsdfMap map(
        {.voxel_size = kVolume.voxel_size * wrong.voxel_size,
         .truncation = kVolume.truncation * wrong.truncation,
         .max_weight = kVolume.max_weight * wrong.max_weight,
         .thin_walls = run_->volume.options().thin_walls,
         .thin_walls_deviations = 4 * wrong.deviations,
         .noise = {.floor = run_->sequence.sensor.noise.floor * wrong.floor,
                   .growth = run_->sequence.sensor.noise.growth * wrong.growth,
                   .bias_growth = run_->sequence.sensor.noise.bias_growth * wrong.bias_growth}});
    Intrinsics camera = GetParam();
    camera.fx *= wrong.focal;
    camera.cy += wrong.centre;
    for (int i = 0; i < kFrames; ++i) {
      Pose pose = run_->sequence.poses[i];
      pose.translation().z() += wrong.shift;
      pose.rotate(Eigen::AngleAxisd(wrong.turn, Eigen::Vector3d::UnitY()));
      map.integrate(allocated_[i], run_->referenceImage(i), run_->sequence.images[i].rgb, camera, pose);
    }
    return map;
  }
  reference::Comparison compareWith(const Wrong& wrong) const {
    return compare(referenceMap(wrong), inReferenceTypes(contents_));
  }

  std::optional<SceneRun> run_;
  std::vector<std::vector<reference::Block>> allocated_;
  VolumeContents contents_;
};

TEST_P(Integrate, AgreesWithTheReference) {
  const reference::TsdfMap map = referenceMap();
  const auto contents = inReferenceTypes(contents_);
  const auto tsdf = compare(map, contents), colour = compareColour(map, contents);
  EXPECT_TRUE(agrees(tsdf, kSkippedShare));
  EXPECT_TRUE(agrees(colour, kSkippedShare));
  EXPECT_GT(tsdf.compared, 50000u);

  // The scene holds what the pass has to tell apart.
  std::size_t carved = 0, behind = 0, capped = 0, coloured = 0, untouched = 0;
  for (const auto& [block, voxels] : map.blocks())
    for (const auto& voxel : voxels) {
      untouched += voxel.updates == 0;
      carved += voxel.updates > 0 && voxel.tsdf == 1;
      behind += voxel.tsdf < 0;
      capped += voxel.updates > kVolume.max_weight;
      coloured += voxel.colour_updates > 0;
    }
  for (const std::size_t count : {carved, behind, capped, coloured, untouched}) EXPECT_GT(count, 2000u);
}

TEST_P(Integrate, ComparisonSeesAWrongCoefficient) {
  EXPECT_TRUE(agrees(compareWith({}), kSkippedShare));
  EXPECT_TRUE(differs(compareWith({.voxel_size = 1.002})));
  EXPECT_TRUE(differs(compareWith({.truncation = 1.01})));
  EXPECT_TRUE(differs(compareWith({.max_weight = 1.2})));
  EXPECT_TRUE(differs(compareWith({.focal = 1.002})));
  EXPECT_TRUE(differs(compareWith({.centre = 0.1})));
  EXPECT_TRUE(differs(compareWith({.shift = 0.001})));
  EXPECT_TRUE(differs(compareWith({.turn = 0.001})));
}

TEST_P(Integrate, DepthsWeighByTheirNoise) {
  fuse(kNoise);
  EXPECT_TRUE(agrees(compareWith({}), kSkippedShare));
  EXPECT_TRUE(differs(compareWith({.growth = 1.05})));
  EXPECT_TRUE(differs(compareWith({.growth = 0})));
  EXPECT_TRUE(differs(compareWith({.bias_growth = 1.05})));
  EXPECT_TRUE(differs(compareWith({.bias_growth = 0})));
  EXPECT_TRUE(differs(compareWith({.floor = 1.05})));
  EXPECT_TRUE(differs(compareWith({.max_weight = 1.2})));
  // Weights below and at the cap are among what was compared.
  std::size_t broken = 0, capped = 0;
  for (const float weight : contents_.weight) {
    broken += weight != std::floor(weight);
    capped += weight == kVolume.max_weight;
  }
  EXPECT_GT(broken, 2000u);
  EXPECT_GT(capped, 500u);
}

TEST_P(Integrate, OneOfContradictoryBacksCounts) {
  VolumeOptions options = kVolume;
  options.thin_walls = true;
  fuse(kNoise, options);
  const reference::TsdfMap map = referenceMap();
  EXPECT_TRUE(agrees(compare(map, inReferenceTypes(contents_)), kSkippedShare));
  EXPECT_TRUE(agrees(compareColour(map, inReferenceTypes(contents_)), kSkippedShare));
  EXPECT_TRUE(differs(compareWith({.deviations = 1.1})));
  std::size_t replaced = 0, kept = 0;
  for (const auto& [block, voxels] : map.blocks())
    for (const auto& voxel : voxels) {
      replaced += voxel.replaced;
      kept += voxel.kept;
    }
  EXPECT_GT(std::min(replaced, kept), 50u) << replaced << ' ' << kept;
}

TEST_P(Integrate, EveryDepthWeighsAtLeastOneUnit) {
  // All depths are beyond 0.8 m, where this noise leaves less than 1/256.
  fuse({.floor = 0.005f, .growth = 1});
  const reference::TsdfMap map = referenceMap();
  const auto contents = inReferenceTypes(contents_);
  EXPECT_TRUE(agrees(compare(map, contents), kSkippedShare));
  std::size_t compared = 0;
  for (std::size_t b = 0; b < contents.blocks.size(); ++b)
    for (int i = 0; i < 512; ++i) {
      const auto& voxel = map.blocks().at(contents.blocks[b])[i];
      if (voxel.uncertain) continue;
      ASSERT_EQ(256 * contents.weight[512 * b + i], voxel.updates);
      compared += voxel.updates > 0;
    }
  EXPECT_GT(compared, 10000u);
}

TEST_P(Integrate, ComparisonSeesWrongColours) {
  reference::TsdfMap map(
      {.voxel_size = kVolume.voxel_size, .truncation = kVolume.truncation, .max_weight = kVolume.max_weight});
  for (int i = 0; i < kFrames; ++i) {
    std::vector<std::uint32_t> swapped;  // red for blue
    for (const std::uint32_t rgb : run_->sequence.images[i].rgb)
      swapped.push_back((rgb & 0xFF00u) | rgb >> 16 | (rgb & 0xFFu) << 16);
    map.integrate(allocated_[i], run_->referenceImage(i), swapped, GetParam(), run_->sequence.poses[i]);
  }
  EXPECT_TRUE(differs(compareColour(map, inReferenceTypes(contents_))));
}

INSTANTIATE_TEST_SUITE_P(Cameras, Integrate, kBothCameras, cameraName);

class IntegrateRules : public ValidatingDevice {};

TEST_F(IntegrateRules, WithoutColourTheTsdfIsTheSame) {
  VolumeOptions plain = kVolume;
  plain.colour = false;
  const Sequence sequence = makeSequence(kPlainCamera, 2, 32);
  SceneRun coloured(device(), sequence, kVolume), colourless(device(), sequence, plain);
  for (SceneRun* run : {&coloured, &colourless}) run->fuseAll();
  const VolumeContents a = coloured.volume.download(), b = colourless.volume.download();
  EXPECT_EQ(a.tsdf, b.tsdf);
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_TRUE(b.colour.empty());
}

TEST_F(IntegrateRules, ColourCanComeAndGo) {
  SceneRun run(device(), makeSequence(kPlainCamera, 1, 33), kVolume);
  run.preprocess.clearColour();
  run.fuse(0);
  run.preprocess.clearColour();
  const auto before = run.volume.download();
  run.integrateDepth(run.sequence.poses[0]);
  const auto after = run.volume.download();
  EXPECT_EQ(before.colour, after.colour);
  EXPECT_NE(before.weight, after.weight);
}

// Half its thickness before and behind z = 0, seen from either side 1.3 m away, in turns of some frames.
TEST_F(IntegrateRules, AThinWallKeepsBothItsSides) {
  constexpr double kHalf = 0.015, kAway = 1.3;
  Sequence sequence = makeSequence(kPlainCamera, 2, 37);
  sequence.poses = {Pose::Identity(), Pose::Identity()};
  sequence.poses[0].translation().z() = -kAway;
  sequence.poses[1].translation().z() = kAway;
  sequence.poses[1].linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  sequence.sensor.noise.floor = 0.004;  // the sides differ by 2 cm at the voxels between them
  for (auto& image : sequence.images)
    std::fill(image.depth.begin(), image.depth.end(), std::lround((kAway - kHalf) * 5000));
  const auto worstError = [&](bool thin_walls) {
    VolumeOptions options{.voxel_size = 0.02f, .truncation = 0.06f};
    options.thin_walls = thin_walls;
    SceneRun run(device(), sequence, options);
    for (const int side : {0, 0, 0, 1, 1, 1, 0}) run.fuse(side);
    const VolumeContents contents = run.volume.download();
    // Voxels (0, 0, k), from k = -4 on.
    std::array<double, 8> tsdf{};
    for (std::size_t slot = 1; slot < contents.blocks.size(); ++slot)
      for (int k = -4; k < 4; ++k)
        if (contents.blocks[slot] == glm::ivec4(0, 0, k < 0 ? -1 : 0, contents.blocks[slot].w))
          tsdf[k + 4] = contents.tsdf[512 * slot + 64 * (k & 7)];
    double front = 1, back = 1;
    for (int i = 0; i + 1 < 8; ++i) {
      const double z = 0.02 * (i - 3.5 + tsdf[i] / (tsdf[i] - tsdf[i + 1]));
      if (tsdf[i] > 0 && tsdf[i + 1] <= 0) front = z;
      if (tsdf[i] <= 0 && tsdf[i + 1] > 0) back = z;
    }
    return std::max(std::abs(front + kHalf), std::abs(back - kHalf));
  };
  EXPECT_LT(worstError(true), 0.002);
  EXPECT_GT(worstError(false), 0.01);
}

TEST_F(IntegrateRules, BlocksBeyondFarAreLeftAlone) {
  SceneRun run(device(), makeSequence(kPlainCamera, 1, 34), kVolume);
  run.load(0);
  run.allocateBlocks(run.sequence.poses[0]);
  constexpr float kFar = 2.3f;
  run.integrate.record(run.recorder, run.volume, run.preprocess.frame(), onDevice(kPlainCamera),
                       onDevice(run.sequence.poses[0].inverse()), kFar);
  run.recorder.submit();
  const VolumeContents contents = run.volume.download();
  const Pose camera_from_world = run.sequence.poses[0].inverse();
  const double side = 8 * kVolume.voxel_size;
  int near_blocks = 0, far_blocks = 0;
  for (std::size_t slot = 1; slot < contents.blocks.size(); ++slot) {
    const glm::ivec4& b = contents.blocks[slot];
    const double z =
        (camera_from_world * (side * (Eigen::Vector3d(b.x, b.y, b.z).array() + 0.5).matrix())).z();
    const auto first = contents.weight.begin() + 512 * slot;
    const bool touched = std::any_of(first, first + 512, [](float w) { return w > 0; });
    if (z > kFar + side) {
      EXPECT_FALSE(touched) << "block centre at " << z << " m";
    }
    if (z < kFar) near_blocks += touched;
    far_blocks += z > kFar + side;
  }
  EXPECT_GT(near_blocks, 10);
  EXPECT_GT(far_blocks, 10);
}

TEST_F(IntegrateRules, BlocksBehindAllSurfacesAreNotLookedAt) {
  // A wall at 2 m, and then one at 1 m before it that leaves half of it in view.
  Sequence sequence = makeSequence(kPlainCamera, 2, 36);
  sequence.poses[1] = sequence.poses[0];
  for (int i = 0; i < 2; ++i)
    std::fill(sequence.images[i].depth.begin(), sequence.images[i].depth.end(), 10000);
  for (int v = 0; v < kPlainCamera.height; ++v)
    std::fill_n(sequence.images[1].depth.begin() + v * kPlainCamera.width, kPlainCamera.width / 2, 5000);
  SceneRun run(device(), sequence, kVolume);
  run.fuse(0);
  const std::uint32_t far_wall = run.volume.blockCount();
  EXPECT_GT(run.integrate.blocks(), 0.8 * far_wall);
  run.load(1);
  run.integrateDepth(sequence.poses[1]);  // no blocks for the near wall: the far one's are left
  EXPECT_LT(run.integrate.blocks(), 0.7 * far_wall);
  EXPECT_GT(run.integrate.blocks(), 0.4 * far_wall);
  // What is seen is fused twice, what is hidden once: nothing that counts was left out.
  const VolumeContents contents = run.volume.download();
  const Pose camera_from_world = sequence.poses[0].inverse();
  int twice = 0, once = 0;
  for (std::size_t i = 512; i < contents.weight.size(); ++i) {
    if (contents.weight[i] == 0) continue;
    const glm::ivec4& b = contents.blocks[i / 512];
    const int l = static_cast<int>(i % 512);
    const Eigen::Vector3d voxel(b.x * 8 + l % 8 + 0.5, b.y * 8 + l / 8 % 8 + 0.5, b.z * 8 + l / 64 + 0.5);
    const Eigen::Vector2d pixel = kPlainCamera.project(camera_from_world * (kVolume.voxel_size * voxel));
    const double beside = pixel.x() - (kPlainCamera.width / 2 - 0.5);
    if (std::abs(beside) < 0.1) continue;
    EXPECT_EQ(contents.weight[i], beside > 0 ? 2 : 1) << "at pixel " << pixel.transpose();
    ++(beside > 0 ? twice : once);
  }
  EXPECT_GT(std::min(twice, once), 1000);
}

TEST_F(IntegrateRules, FewWorkgroupsPerRowGiveTheSameVolume) {
  // A device that dispatches at most 11 workgroups along x gets rows of them, the last one not full.
  DeviceOptions options = deviceUnderTest();
  options.limits_at_most.max_workgroup_count_x = 11;
  Device narrow(options);
  const Sequence sequence = makeSequence(kPlainCamera, 1, 35);
  // Preprocess and integrate, that is; allocate's groups are few.
  SceneRun wide_run(device(), sequence, kVolume), narrow_run(narrow, sequence, kVolume);
  for (SceneRun* run : {&wide_run, &narrow_run}) run->fuseAll();
  EXPECT_EQ(wide_run.volume.download().tsdf, narrow_run.volume.download().tsdf);
  EXPECT_EQ(wide_run.volume.download().weight, narrow_run.volume.download().weight);
  EXPECT_THAT(narrow.validationMessages(), ::testing::IsEmpty());
}

}  // namespace test_integrate
}  // namespace rosefusion::testing
