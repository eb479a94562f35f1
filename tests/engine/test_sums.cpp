// Compensated summation survives the driver's compiler, alone and inside the fitness.
#include <cmath>

#include "engine/passes/fitness.h"
#include "engine/passes/sum_check.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_sums {

class Sums : public ValidatingDevice {};

TEST_F(Sums, TheMeanThatAPlainSumMakesZero) {
  const float values[] = {16777216.0f, 1.0f, -16777216.0f};
  const SumCheck sums = sumOnDevice(device(), values);
  EXPECT_EQ(sums.compensated / 3, 1.0f / 3.0f);
  EXPECT_EQ(sums.plain, 0.0f) << "the comparison shows nothing: this plain sum is compensated too";
  EXPECT_TRUE(compensatedSumsWork(device()));
}

// Longer than the 65535 iterations after which Mesa's llvmpipe ends a loop: the passes must split what is
// longer.
TEST_F(Sums, ALongAlternatingSeries) {
  std::vector<float> values(1 << 20);
  double exact = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = i % 2 == 0 ? 0.3f : -0.1f;
    exact += values[i];
  }
  const SumCheck sums = sumOnDevice(device(), values);
  // Kahan's bound is 2 ulp of the sum of magnitudes, twice the sum here, of which the result's own rounding
  // is half one.
  EXPECT_NEAR(sums.compensated, exact, 1e-7 * exact);
  EXPECT_GT(std::abs(sums.plain - exact), 1e-3 * exact);
}

/// A wall seen through a lens so long that all pixels fall into one voxel: every term of the loss is the same
/// number.
class SumsInFitness : public ValidatingDevice {
 protected:
  static constexpr Intrinsics kLens{640, 480, 1e5, 1e5, 319.5, 239.5};

  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    reference::Image wall{.depth = std::vector<std::uint16_t>(640 * 480, 10000), .rgb = {}};
    // The voxel's centre is 3 cm in front of the wall, 2 m away.
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(0.05, 0.05, -1.92);
    run_.emplace(device(), Sequence{kLens, {.metres_per_unit = double(1 / 5000.0f)}, {pose}, {wall}},
                 VolumeOptions{.voxel_size = 0.1f, .truncation = 0.1f});
    run_->fuseAll();
    points_.emplace(device(), onDevice(kLens));
    points_->record(run_->recorder, run_->preprocess.frame(), {1, 0, 0}, nullptr);
    run_->recorder.submit();
    const auto contents = run_->volume.download();
    const auto values = inReferenceTypes(contents);
    for (std::size_t b = 0; b < values.blocks.size(); ++b)
      if (values.blocks[b] == reference::Block{0, 0, 0}) psi_ = values.tsdf[512 * b];  // voxel (0, 0, 0)
  }
  double lossOf(Loss loss, bool compensate, std::uint32_t slices) {
    const std::vector<glm::vec4> stay(2, glm::vec4(0));
    FitnessPass pass(device(), stay, loss, compensate, slices);
    pass.record(run_->recorder, run_->volume, *points_,
                {.world_from_camera = onDevice(run_->sequence.poses[0]), .particles = 1});
    run_->recorder.submit();
    return pass.losses()[0];
  }

  std::optional<SceneRun> run_;
  std::optional<SelectPointsPass> points_;
  double psi_ = 1;
};

TEST_F(SumsInFitness, CompensationKeepsEveryPoint) {
  ASSERT_EQ(points_->selected(), 640u * 480u);
  ASSERT_GT(psi_, 0.1);
  ASSERT_LT(psi_, 0.9);
  for (const std::uint32_t slices : {1u, 8u}) {
    // Rounding of the term, of the sum and of the mean.
    EXPECT_NEAR(lossOf(Loss::Squared, true, slices), psi_ * psi_, 2e-7 * psi_ * psi_) << slices << " slices";
    EXPECT_NEAR(lossOf(Loss::Absolute, true, slices), psi_, 2e-7 * psi_) << slices << " slices";
  }
  // Without it, the same test fails by far; the points are more than one loop may hold, so there are 10
  // slices here.
  EXPECT_GT(std::abs(lossOf(Loss::Squared, false, 1) - psi_ * psi_), 1e-5 * psi_ * psi_);
  EXPECT_GT(std::abs(lossOf(Loss::Absolute, false, 1) - psi_), 1e-5 * psi_);
}

}  // namespace test_sums
}  // namespace rosefusion::testing
