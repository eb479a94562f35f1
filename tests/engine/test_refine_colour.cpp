// Pass refine_colour against its reference.
#include <functional>

#include "engine/error.h"
#include "engine/passes/refine_colour.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/refine_colour.h"
#include "tests/reference/select_points.h"

namespace rosefusion::testing {
namespace test_refine_colour {

constexpr VolumeOptions kVolume{.voxel_size = 0.04f, .truncation = 0.12f, .colour = true};
constexpr PixelGrid kGrid{5, 2, 3};
constexpr int kFrames = 3;
constexpr double kWideShare = 0.1;                // of the sums, as of pass refine
constexpr double kHuber = 0.0625, kGain = 1.125;  // exact floats

class RefineColour : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    run_.emplace(device(), makeSequence(GetParam(), kFrames, 71), kVolume);
    run_->fuseAll();
    contents_ = run_->volume.download();
    reference_contents_ = inReferenceTypes(contents_);
    points_.emplace(device(), onDevice(GetParam()));
    points_->record(run_->recorder, run_->preprocess.frame(), kGrid, nullptr);
    run_->recorder.submit();
    const auto selection = selectPoints(run_->referenceImage(kFrames - 1), GetParam(), kGrid.stride,
                                        kGrid.offset_x, kGrid.offset_y, nullptr);
    for (const auto& candidate : selection.points) reference_points_.push_back(candidate.point);
    model_ = {GetParam(), run_->sequence.images[kFrames - 1].rgb, kHuber, kGain};
    const Pose truth = run_->sequence.poses[kFrames - 1];
    for (const double off : {0.0, 0.2, -0.5, 1.0, -2.0, 6.0}) {
      Pose pose = truth;
      pose.translation() += off * Eigen::Vector3d(0.02, -0.03, 0.025);
      pose.rotate(Eigen::AngleAxisd(off * 0.03, Eigen::Vector3d(1, 2, -1).normalized()));
      pose.matrix() = pose.matrix().cast<float>().cast<double>();  // as the device gets it
      poses_.push_back(pose);
    }
  }

  std::vector<RefineColourSums> sums(SceneRun& run, double gain = kGain) {
    std::vector<shader::RefineColourCandidate> candidates;
    for (const Pose& pose : poses_)
      candidates.push_back({onDevice(pose), glm::vec4(static_cast<float>(gain), 0, 0, 0)});
    RefineColourPass pass(device());
    pass.record(run.recorder, run.volume, run_->preprocess.frame(), *points_, onDevice(GetParam()),
                candidates, kHuber);
    run.recorder.submit();
    return pass.sums();
  }
  reference::Comparison compareWith(const std::vector<RefineColourSums>& measured,
                                    const reference::ColourModel& model,
                                    double voxel_size = kVolume.voxel_size) const {
    const reference::VoxelColours colours(reference_contents_.blocks, reference_contents_.colour, voxel_size);
    std::vector<reference::SumRange> expected;
    std::vector<double> flat;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const auto ranges = refineColourSums(colours, reference_points_, poses_[i], model);
      expected.insert(expected.end(), ranges.begin(), ranges.end());
      flat.insert(flat.end(), measured[i].begin(), measured[i].end());
    }
    return compare(expected, flat, reference::kRefineColourSums);
  }

  std::optional<SceneRun> run_;
  std::optional<SelectPointsPass> points_;
  VolumeContents contents_;
  reference::TsdfContents reference_contents_;
  std::vector<Eigen::Vector3d> reference_points_;
  std::vector<Pose> poses_;
  reference::ColourModel model_;
};

TEST_P(RefineColour, AgreesWithTheReferenceAtSeveralPoses) {
  ASSERT_GT(reference_points_.size(), 600u);
  const auto measured = sums(*run_);
  ASSERT_EQ(measured.size(), poses_.size());
  EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  // The poses hold what the pass has to tell apart.
  const auto &truth = measured.front(), &far = measured.back();
  EXPECT_GT(truth[shader::kRefineColourPoints], 0.7 * reference_points_.size());
  EXPECT_LT(far[shader::kRefineColourPoints], 0.9 * reference_points_.size());
  EXPECT_GT(far[shader::kRefineColourPoints], 0.1 * reference_points_.size());
}

TEST_P(RefineColour, ComparisonSeesAWrongCoefficient) {
  const auto measured = sums(*run_);
  EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  EXPECT_TRUE(differs(compareWith(measured, model_, kVolume.voxel_size * 1.002)));
  const auto wrong = [&](const std::function<void(reference::ColourModel&)>& change) {
    reference::ColourModel model = model_;
    change(model);
    return compareWith(measured, model);
  };
  EXPECT_TRUE(differs(wrong([](auto& m) { m.huber *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.gain *= 1.002; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.turn_sense = -1; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.green *= 1.002; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.camera.cx += 1; })));
}

TEST_P(RefineColour, TheGainsDerivativeIsThatOfTheCost) {
  poses_ = {poses_[2]};
  constexpr double kStep = 0.0078125;
  const auto cost = [&](double gain) { return sums(*run_, gain)[0][shader::kRefineColourCost]; };
  const double slope = (cost(kGain + kStep) - cost(kGain - kStep)) / (2 * kStep);
  EXPECT_NEAR(sums(*run_)[0][shader::kRefineColourGradient + 6], slope, 0.01 * std::abs(slope));
}

TEST_P(RefineColour, SeveralPoolBuffersGiveTheSameSums) {
  VolumeOptions options = kVolume;
  options.max_pool_bytes = 2048;  // of the colours' pool; see pass refine's test
  while (options.max_pool_bytes * 4 < 2048 * (run_->volume.blockCount() + 1)) options.max_pool_bytes *= 2;
  SceneRun chunked(device(), run_->sequence, options);
  chunked.fuseAll();
  ASSERT_GT(chunked.volume.chunks(), 1u);
  EXPECT_EQ(sums(chunked), sums(*run_));
}

TEST_P(RefineColour, WithoutColourInTheModelAllSumsAreZero) {
  SceneRun empty(device(), run_->sequence, kVolume);
  for (const RefineColourSums& s : sums(empty)) EXPECT_EQ(s, RefineColourSums{});
  for (const Eigen::Vector3d& away : {Eigen::Vector3d(100, 0, 0), Eigen::Vector3d(0, 0, 1e7)}) {
    for (Pose& pose : poses_) pose.translation() = away;
    for (const RefineColourSums& s : sums(*run_)) EXPECT_EQ(s, RefineColourSums{});
  }
}

TEST_P(RefineColour, RefusesAFrameOrAVolumeWithoutColour) {
  VolumeOptions options = kVolume;
  options.colour = false;
  SceneRun grey(device(), run_->sequence, options);
  EXPECT_THROW(sums(grey), DeviceError);
  run_->preprocess.clearColour();
  EXPECT_THROW(sums(*run_), DeviceError);
}

INSTANTIATE_TEST_SUITE_P(Cameras, RefineColour, kBothCameras, cameraName);

}  // namespace test_refine_colour
}  // namespace rosefusion::testing
