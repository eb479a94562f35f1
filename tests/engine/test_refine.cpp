// Pass refine against its reference.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/passes/refine.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/refine.h"
#include "tests/reference/select_points.h"

namespace rosefusion::testing {
namespace test_refine {

constexpr VolumeOptions kVolume{.voxel_size = 0.04f, .truncation = 0.12f};
constexpr PixelGrid kGrid{5, 2, 3};
constexpr int kFrames = 3;
// Of the sums: those of a pose where a few points read a distance or not within rounding are too wide to
// test much.
constexpr double kWideShare = 0.1;
// Float values, so that both sides weigh by the same numbers.
const reference::RefineModel kSensor{.truncation = kVolume.truncation,
                                     .huber = 0.02f,
                                     .noise = {.floor = 0.005f, .growth = 0.0019f, .bias_growth = 0.003f},
                                     .model_noise = 0.016f};

class Refine : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    run_.emplace(device(), makeSequence(GetParam(), kFrames, 71), kVolume);
    run_->fuseAll();
    contents_ = run_->volume.download();
    reference_contents_ = inReferenceTypes(contents_);
    select(*run_);
    const auto selection = selectPoints(run_->referenceImage(kFrames - 1), GetParam(), kGrid.stride,
                                        kGrid.offset_x, kGrid.offset_y, nullptr);
    for (const auto& candidate : selection.points) reference_points_.push_back(candidate.point);
    model_.last_from_world = asFloats(run_->sequence.poses[kFrames - 2].inverse());
    model_.last_camera = GetParam();
    // The truth, a few centimetres and degrees off it, and so far off that little overlaps.
    const Pose truth = run_->sequence.poses[kFrames - 1];
    for (const double off : {0.0, 0.2, -0.5, 1.0, -2.0, 6.0}) {
      Pose pose = truth;
      pose.translation() += off * Eigen::Vector3d(0.02, -0.03, 0.025);
      pose.rotate(Eigen::AngleAxisd(off * 0.03, Eigen::Vector3d(1, 2, -1).normalized()));
      poses_.push_back(asFloats(pose));
    }
  }

  /// A wall of which 1 / z falls by `slope` a pixel, and poses_ before it and turned about a line in it, at
  /// `depth`: from there the same points lie on the wall and see it from behind.
  void turnAboutASteepWall(double slope, float truncation, double depth) {
    Sequence wall = makeSequence(GetParam(), 1, 72);
    for (std::size_t i = 0; i < wall.images[0].depth.size(); ++i)
      wall.images[0].depth[i] =
          std::uint16_t(std::lround(5000 / (1 - slope * double(i % std::size_t(GetParam().width)))));
    VolumeOptions wide = kVolume;
    wide.truncation = truncation;  // so that grazing views read distances
    model_.truncation = truncation;
    run_.emplace(device(), wall, wide);
    run_->fuseAll();
    contents_ = run_->volume.download();
    reference_contents_ = inReferenceTypes(contents_);
    select(*run_);
    reference_points_.clear();
    const auto selection = selectPoints(run_->referenceImage(0), GetParam(), kGrid.stride, kGrid.offset_x,
                                        kGrid.offset_y, nullptr);
    for (const auto& candidate : selection.points) reference_points_.push_back(candidate.point);
    const Eigen::Vector3d middle = *std::min_element(
        reference_points_.begin(), reference_points_.end(),
        [&](const auto& p, const auto& q) { return std::abs(p.z() - depth) < std::abs(q.z() - depth); });
    const Pose truth = wall.poses[0];
    const Pose behind = truth * Eigen::Translation3d(middle) *
                        Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()) *
                        Eigen::Translation3d(-middle);
    poses_ = {asFloats(truth), asFloats(behind)};
    model_.last_from_world = asFloats(truth.inverse());
  }

  /// The same pose as the device gets it.
  static Pose asFloats(const Pose& pose) {
    Pose out = pose;
    out.matrix() = pose.matrix().cast<float>().cast<double>();
    return out;
  }
  void select(SceneRun& run) {
    points_.emplace(device(), onDevice(GetParam()));
    points_->record(run.recorder, run.preprocess.frame(), kGrid, nullptr);
    run.recorder.submit();
  }
  std::vector<RefineSums> sums(SceneRun& run, const std::vector<Pose>& poses) {
    const Intrinsics& k = GetParam();
    const glm::mat4 image(glm::vec4(k.fx, 0, 0, 0), glm::vec4(0, k.fy, 0, 0), glm::vec4(k.cx, k.cy, 1, 0),
                          glm::vec4(0, 0, 0, 1));
    std::vector<shader::RefineCandidate> candidates;
    for (const Pose& pose : poses)
      candidates.push_back({onDevice(pose), image * onDevice(Pose(model_.last_from_world * pose))});
    pass_.emplace(device());
    pass_->record(run.recorder, run.volume, *points_, candidates, onDevice(k),
                  {static_cast<float>(model_.huber), onDevice(model_.noise),
                   static_cast<float>(model_.model_noise), model_.front_only});
    run.recorder.submit();
    return pass_->sums();
  }
  reference::Comparison compareWith(const std::vector<RefineSums>& measured,
                                    const reference::RefineModel& model,
                                    double voxel_size = kVolume.voxel_size) const {
    const reference::VoxelValues values(reference_contents_.blocks, reference_contents_.tsdf, voxel_size);
    const reference::VoxelValues weights(reference_contents_.blocks, reference_contents_.weight, voxel_size);
    std::vector<reference::SumRange> expected;
    std::vector<double> flat;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const auto ranges = refineSums(values, weights, reference_points_, poses_[i], model);
      expected.insert(expected.end(), ranges.begin(), ranges.end());
      flat.insert(flat.end(), measured[i].begin(), measured[i].end());
    }
    return compare(expected, flat);
  }

  std::optional<SceneRun> run_;
  std::optional<SelectPointsPass> points_;
  std::optional<RefinePass> pass_;
  VolumeContents contents_;
  reference::TsdfContents reference_contents_;
  std::vector<Eigen::Vector3d> reference_points_;
  std::vector<Pose> poses_;
  reference::RefineModel model_ = kSensor;
};

TEST_P(Refine, AgreesWithTheReferenceAtSeveralPoses) {
  ASSERT_GT(reference_points_.size(), 600u);
  const auto measured = sums(*run_, poses_);
  ASSERT_EQ(measured.size(), poses_.size());
  const auto result = compareWith(measured, model_);
  EXPECT_TRUE(agrees(result, kWideShare));
  EXPECT_EQ(result.compared, poses_.size() * reference::kRefineSums);
  // The poses hold what the pass has to tell apart.
  const auto& truth = measured.front();
  const auto& far = measured.back();
  EXPECT_GT(truth[shader::kRefineUsable], 0.8 * reference_points_.size());
  EXPECT_GT(truth[shader::kRefineClose], 0.9 * truth[shader::kRefineUsable]);
  EXPECT_LT(far[shader::kRefineUsable], 0.9 * reference_points_.size());
  EXPECT_GT(far[shader::kRefineUsable], 0.1 * reference_points_.size());
  EXPECT_LT(far[shader::kRefineClose], 0.7 * far[shader::kRefineUsable]);
  EXPECT_LT(truth[shader::kRefineCost], 0.3 * far[shader::kRefineCost]);
}

TEST_P(Refine, ComparisonSeesAWrongCoefficient) {
  const auto measured = sums(*run_, poses_);
  EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  EXPECT_TRUE(differs(compareWith(measured, model_, kVolume.voxel_size * 1.002)));
  const auto wrong = [&](const std::function<void(reference::RefineModel&)>& change) {
    reference::RefineModel model = model_;
    change(model);
    return compareWith(measured, model);
  };
  EXPECT_TRUE(differs(wrong([](auto& m) { m.huber *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.truncation *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.noise.floor *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.noise.growth *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.noise.growth = 0; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.noise.bias_growth *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.noise.bias_growth = 0; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.model_noise *= 1.01; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.turn_sense = -1; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.close_deviations *= 1.1; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.last_camera.cx += 3; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.last_camera.width = 100 * m.last_camera.width; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.last_from_world.translation().x() += 0.02; })));
  const std::vector<Pose> right = poses_;
  for (Pose& pose : poses_) pose.translation().y() += 0.001;
  EXPECT_TRUE(differs(compareWith(measured, model_)));
  poses_ = right;
  for (Pose& pose : poses_) pose.rotate(Eigen::AngleAxisd(0.001, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(differs(compareWith(measured, model_)));
  poses_ = right;
  reference_points_.erase(reference_points_.begin() +
                          static_cast<std::ptrdiff_t>(reference_points_.size() / 2));
  EXPECT_TRUE(differs(compareWith(measured, model_)));
}

TEST_P(Refine, SurfacesSeenFromBehindAreLeftOutOnDemand) {
  turnAboutASteepWall(0.005, 0.3f, 2);
  const auto all = sums(*run_, poses_);
  EXPECT_TRUE(agrees(compareWith(all, model_), kWideShare));
  model_.front_only = true;
  const auto measured = sums(*run_, poses_);
  EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  EXPECT_EQ(measured[0], all[0]) << "seen from the front";
  EXPECT_GT(all[1][shader::kRefineUsable], 100);
  EXPECT_LT(measured[1][shader::kRefineUsable], 0.5 * all[1][shader::kRefineUsable]);
  EXPECT_GT(measured[1][shader::kRefineUsable], 0) << "grazing views are left in";
  for (const double wrong : {-0.9, 0.5}) {
    model_.back_cosine = wrong;
    EXPECT_TRUE(differs(compareWith(measured, model_))) << wrong;
  }
  model_.back_cosine = 0.2;
  model_.front_only = false;
  EXPECT_TRUE(differs(compareWith(measured, model_)));
}

TEST_P(Refine, ComparisonSeesTheAngleOfBacks) {
  turnAboutASteepWall(0.0052, 0.5f, 3);
  model_.front_only = true;
  const auto measured = sums(*run_, poses_);
  EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  for (const double wrong : {0.15, 0.25}) {
    model_.back_cosine = wrong;
    EXPECT_TRUE(differs(compareWith(measured, model_))) << wrong;
  }
}

TEST_P(Refine, PosesDoNotInfluenceOneAnother) {
  const auto together = sums(*run_, poses_);
  for (std::size_t i = 0; i < poses_.size(); ++i)
    EXPECT_EQ(sums(*run_, {poses_[i]})[0], together[i]) << "pose " << i;
  const std::vector<Pose> reversed(poses_.rbegin(), poses_.rend());
  const auto backwards = sums(*run_, reversed);
  for (std::size_t i = 0; i < poses_.size(); ++i)
    EXPECT_EQ(backwards[poses_.size() - 1 - i], together[i]) << "pose " << i;
}

TEST_P(Refine, SeveralPoolBuffersGiveTheSameSums) {
  VolumeOptions options = kVolume;
  // Of each pool, whose block is 1 KiB: a power of two, so that four chunks hold what one did.
  options.max_pool_bytes = 1024;
  while (options.max_pool_bytes * 4 < 1024 * (run_->volume.blockCount() + 1)) options.max_pool_bytes *= 2;
  SceneRun chunked(device(), run_->sequence, options);
  chunked.fuseAll();
  ASSERT_GT(chunked.volume.chunks(), 1u);
  const auto whole = sums(*run_, poses_);
  EXPECT_EQ(sums(chunked, poses_), whole);
}

TEST_P(Refine, WithoutASurfaceOnlyTheCostsCount) {
  // An empty volume, and poses that look from beyond the table at nothing, which the last image is to have
  // seen.
  const auto seeAll = [&] { model_.last_from_world = poses_.front().inverse(); };
  SceneRun empty(device(), run_->sequence, kVolume);
  const auto check = [&](const std::vector<RefineSums>& measured) {
    for (const RefineSums& s : measured) {
      for (int k = 0; k < int(shader::kRefineSums); ++k)
        if (k != int(shader::kRefineCost) && k != int(shader::kRefineMostCost)) {
          EXPECT_EQ(s[k], 0) << "sum " << k;
        }
      EXPECT_EQ(s[shader::kRefineCost], s[shader::kRefineMostCost]);
      EXPECT_GT(s[shader::kRefineMostCost], 0);
    }
  };
  poses_.resize(1);
  seeAll();
  check(sums(empty, poses_));
  for (const Eigen::Vector3d& away : {Eigen::Vector3d(100, 0, 0), Eigen::Vector3d(0, -1e6, 0),
                                      Eigen::Vector3d(0, 0, 1e7), Eigen::Vector3d(-30, 0, 0)}) {
    poses_.front().translation() = away;
    seeAll();
    check(sums(*run_, poses_));
  }
}

TEST_P(Refine, WithoutPointsAllSumsAreZero) {
  const std::vector<std::uint16_t> nothing(run_->sequence.images[0].depth.size(), 0);
  run_->preprocess.record(run_->recorder, nothing, 0.001f, 0.1f, 5.0f);
  select(*run_);
  for (const RefineSums& s : sums(*run_, poses_)) EXPECT_EQ(s, RefineSums{});
}

INSTANTIATE_TEST_SUITE_P(Cameras, Refine, kBothCameras, cameraName);

}  // namespace test_refine
}  // namespace rosefusion::testing
