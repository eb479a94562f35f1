// Passes fitness and fitness_reduce against their reference.
#include <random>

#include "engine/passes/fitness.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/fitness.h"
#include "tests/reference/select_points.h"

namespace rosefusion::testing {
namespace test_fitness {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr VolumeOptions kVolume{.voxel_size = 0.04f, .truncation = 0.12f};
constexpr int kParticles = 200;  // two templates of 100; not a multiple of the workgroup
// Particles whose range, from points on a voxel's face, is wider than 2e-3.
constexpr double kWideShare = 0.02;
constexpr PixelGrid kGrid{5, 2, 3};
constexpr int kTogether = 4;  // particles that an invocation of the pass carries

/// What the reference is given; the defaults are what the engine gets.
struct Swarm {
  Pose centre = Pose::Identity();
  Vector6 lengths = Vector6::Constant(0.2);
  Loss loss = Loss::Squared;
  int first = 0, count = kParticles;
  float race_margin = 0;
};

class Fitness : public ValidatingDevice {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    run_.emplace(device(), makeSequence(kOddCamera, 3, 51), kVolume);
    run_->fuseAll();
    contents_ = run_->volume.download();
    reference_contents_ = inReferenceTypes(contents_);
    points_.emplace(device(), onDevice(kOddCamera));
    points_->record(run_->recorder, run_->preprocess.frame(), kGrid, nullptr);
    run_->recorder.submit();
    const auto selection = selectPoints(run_->referenceImage(2), kOddCamera, kGrid.stride, kGrid.offset_x,
                                        kGrid.offset_y, nullptr);
    for (const auto& candidate : selection.points) reference_points_.push_back(candidate.point);
    swarm_.centre = run_->sequence.poses[2];
    // Axis lengths as in a first iteration; float values, so that both sides multiply the same numbers.
    for (int i = 0; i < 6; ++i) swarm_.lengths[i] = static_cast<float>(0.08 + 0.03 * i);

    std::mt19937 random(52);
    for (int i = 0; i < kParticles; ++i) {
      Vector6 entry = Vector6::Zero();  // particle 0 stays
      if (i > 0)
        for (int k = 0; k < 6; ++k) entry[k] = static_cast<float>(random() / 2147483648.0 - 1);
      if (i > 0) entry *= 0.5 + 0.5 / entry.norm();
      entry = entry.cast<float>().cast<double>();
      entries_.push_back(entry);
      templates_.emplace_back(entry[0], entry[1], entry[2], 0);
      templates_.emplace_back(entry[3], entry[4], entry[5], 0);
    }
  }

  static SwarmPlacement placement(const Swarm& swarm) {
    const auto& l = swarm.lengths;
    return {onDevice(swarm.centre),     glm::vec4(l[0], l[1], l[2], 0), glm::vec4(l[3], l[4], l[5], 0),
            std::uint32_t(swarm.first), std::uint32_t(swarm.count),     swarm.race_margin};
  }

  std::vector<float> losses(const Swarm& swarm, std::uint32_t slices, bool compensate = true) {
    FitnessPass pass(device(), templates_, swarm.loss, compensate, slices);
    pass.record(run_->recorder, run_->volume, *points_, placement(swarm));
    run_->recorder.submit();
    return {pass.losses().begin(), pass.losses().end()};
  }

  std::vector<reference::LossRange> expected(const Swarm& swarm,
                                             double voxel_size = kVolume.voxel_size) const {
    const reference::VoxelValues values(reference_contents_.blocks, reference_contents_.tsdf, voxel_size);
    const auto kind =
        swarm.loss == Loss::Squared ? reference::LossKind::Squared : reference::LossKind::Absolute;
    std::vector<reference::LossRange> ranges;
    for (int i = swarm.first; i < swarm.first + swarm.count; ++i)
      ranges.push_back(meanLoss(values, reference_points_,
                                reference::particlePose(swarm.centre, entries_[i], swarm.lengths), kind));
    return ranges;
  }

  std::optional<SceneRun> run_;
  std::optional<SelectPointsPass> points_;
  VolumeContents contents_;
  reference::TsdfContents reference_contents_;
  std::vector<Eigen::Vector3d> reference_points_;
  std::vector<Vector6> entries_;
  std::vector<glm::vec4> templates_;
  Swarm swarm_;
};

TEST_F(Fitness, AgreesForEachLossAndSlice) {
  ASSERT_GT(reference_points_.size(), 600u);
  for (const Loss loss : {Loss::Squared, Loss::Absolute}) {
    swarm_.loss = loss;
    const auto ranges = expected(swarm_);
    for (const std::uint32_t slices : {0u, 1u, 2u, 7u, 64u}) {
      SCOPED_TRACE(std::to_string(slices) + " slices");
      EXPECT_TRUE(agrees(compare(ranges, losses(swarm_, slices)), kWideShare));
    }
    // The particles differ, and the one that stays is the best: its frame is in the model.
    EXPECT_LT(ranges[0].high, 0.2 * ranges[1].low);
  }
}

TEST_F(Fitness, TemplatePartStartsAtItsFirstParticle) {
  swarm_.first = 70;
  swarm_.count = 65;
  EXPECT_TRUE(agrees(compare(expected(swarm_), losses(swarm_, 1)), kWideShare));
  EXPECT_TRUE(agrees(compare(expected(swarm_), losses(swarm_, 3)), kWideShare));
  swarm_.first = 150;
  EXPECT_TRUE(
      throwsDeviceError([&] { losses(swarm_, 1); }, DeviceErrorCode::Programming, {"past the templates"}));
}

/// Passes fitness and fitness_reduce with racing.
class FitnessRace : public Fitness {
 protected:
  static constexpr float kMargin = 2;

  void run(double size, float margin) {
    swarm_.loss = Loss::Absolute;
    swarm_.race_margin = margin;
    swarm_.lengths = (size * swarm_.lengths).cast<float>().cast<double>();
    pass_.emplace(device(), templates_, swarm_.loss, true, 1);
    pass_->record(run_->recorder, run_->volume, *points_, placement(swarm_));
    run_->recorder.submit();
  }

  std::vector<reference::RaceEnd> ends(double margin) const {
    const reference::VoxelValues values(reference_contents_.blocks, reference_contents_.tsdf,
                                        kVolume.voxel_size);
    std::vector<std::vector<reference::LossRange>> losses;
    for (const Vector6& entry : entries_) {
      const Pose pose = reference::particlePose(swarm_.centre, entry, swarm_.lengths);
      losses.emplace_back();
      for (const Eigen::Vector3d& point : reference_points_)
        losses.back().push_back(lossOf(values, point, pose, reference::LossKind::Absolute));
    }
    return reference::race(losses, kTogether, margin);
  }

  std::optional<FitnessPass> pass_;
};

TEST_F(FitnessRace, NobodyLeavesWithoutAMargin) {
  run(1, 0);
  EXPECT_EQ(pass_->lookups(), kParticles * reference_points_.size());
}

// As in a first iteration: nearly all are given up after their first points.
TEST_F(FitnessRace, PointsLookedUpAreThoseOfTheReference) {
  run(1, kMargin);
  std::uint64_t walked = 0;
  for (const reference::RaceEnd& end : ends(kMargin)) {
    ASSERT_FALSE(end.close);
    walked += end.walked;
  }
  EXPECT_EQ(pass_->lookups(), walked);
  EXPECT_LT(walked, kParticles * reference_points_.size() / 4);
}

// As later in a search: some stay, and have their whole loss.
TEST_F(FitnessRace, WhoIsGivenUpIsAsInTheReference) {
  run(0.14, kMargin);
  const auto ranges = expected(swarm_);
  const auto disagreements = [&](double margin) {
    int wrong = 0, close = 0, given_up = 0;
    std::vector<reference::LossRange> stayed;
    std::vector<float> measured;
    const auto all = ends(margin);
    for (int i = 0; i < kParticles; ++i) {
      const bool lost = pass_->losses()[i] < 0;
      EXPECT_EQ(lost, pass_->counted()[i] == 0);
      close += all[i].close;
      given_up += all[i].given_up;
      wrong += !all[i].close && all[i].given_up != lost;
      if (lost) continue;
      stayed.push_back(ranges[i]);
      measured.push_back(pass_->losses()[i]);
    }
    EXPECT_LT(close, kParticles / 4);
    EXPECT_GT(given_up, kParticles / 3) << "too few leave the race for the test to mean something";
    EXPECT_TRUE(agrees(compare(stayed, measured), 0.05));
    return wrong;
  };
  EXPECT_EQ(disagreements(kMargin), 0);
  EXPECT_GT(disagreements(kMargin * 1.3), 0);
  EXPECT_GT(disagreements(kMargin / 1.3), 0);
}

// As preset default runs it: each particle in its own overlap with the last view.
TEST_F(FitnessRace, WithItsOwnOverlapWhoStaysHasTheWholeLoss) {
  Pose last = swarm_.centre;
  last.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
  const LastView view{onDevice(Pose(last.inverse())), onDevice(kOddCamera)};
  swarm_.loss = Loss::Absolute;
  swarm_.lengths = (0.14 * swarm_.lengths).cast<float>().cast<double>();
  FitnessPass pass(device(), templates_, swarm_.loss, true, 1);
  const auto run = [&](float margin) {
    swarm_.race_margin = margin;
    pass.record(run_->recorder, run_->volume, *points_, placement(swarm_), &view);
    run_->recorder.submit();
    return std::vector<float>(pass.losses().begin(), pass.losses().end());
  };
  const std::vector<float> whole = run(0);
  const std::vector<std::uint32_t> counted(pass.counted().begin(), pass.counted().end());
  const std::vector<float> raced = run(kMargin);
  int given_up = 0;
  for (int i = 0; i < kParticles; ++i) {
    const bool left = raced[i] < 0;
    given_up += left;
    EXPECT_EQ(pass.counted()[i], left ? 0 : counted[i]) << "particle " << i;
    if (left)
      EXPECT_GT(whole[i], whole[0]) << "particle " << i;
    else
      EXPECT_NEAR(raced[i], whole[i], 1e-6) << "particle " << i;
  }
  EXPECT_GT(given_up, kParticles / 4);
  EXPECT_LT(given_up, kParticles - kTogether);
}

TEST_F(Fitness, SlicesGiveNobodyUp) {
  swarm_.loss = Loss::Absolute;
  const auto without = losses(swarm_, 3);
  swarm_.race_margin = 0.1f;
  EXPECT_EQ(losses(swarm_, 3), without);
  const auto raced = losses(swarm_, 1);
  EXPECT_GT(std::count(raced.begin(), raced.end(), -1.0f), 0);
}

TEST_F(Fitness, RotationsBeyondHalfATurnStopThere) {
  swarm_.lengths.tail<3>().setConstant(3);
  EXPECT_TRUE(agrees(compare(expected(swarm_), losses(swarm_, 1)), kWideShare));
}

/// The points that the particle's pose puts into the image of a camera at `last` [eq:validness, per
/// particle].
std::vector<Eigen::Vector3d> pointsInView(const std::vector<Eigen::Vector3d>& points, const Pose& particle,
                                          const Pose& last, double fx) {
  std::vector<Eigen::Vector3d> seen;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = last.inverse() * (particle * p);
    if (q.z() <= 0) continue;
    const double u = fx * q.x() / q.z() + kOddCamera.cx, v = kOddCamera.fy * q.y() / q.z() + kOddCamera.cy;
    if (std::lround(u) >= 0 && std::lround(v) >= 0 && std::lround(u) < kOddCamera.width &&
        std::lround(v) < kOddCamera.height)
      seen.push_back(p);
  }
  return seen;
}

TEST_F(Fitness, EachParticleCountsItsOwnOverlap) {
  Pose last = swarm_.centre;  // a turn to the side, so that the overlap differs from particle to particle
  last.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
  FitnessPass pass(device(), templates_, swarm_.loss, true, 3);
  const LastView view{onDevice(Pose(last.inverse())), onDevice(kOddCamera)};
  pass.record(run_->recorder, run_->volume, *points_, placement(swarm_), &view);
  run_->recorder.submit();

  const reference::VoxelValues values(reference_contents_.blocks, reference_contents_.tsdf,
                                      kVolume.voxel_size);
  const auto ranges = [&](double fx) {
    std::vector<reference::LossRange> out;
    for (int i = 0; i < kParticles; ++i) {
      const auto pose = reference::particlePose(swarm_.centre, entries_[i], swarm_.lengths);
      const auto seen = pointsInView(reference_points_, pose, last, fx);
      out.push_back(meanLoss(values, seen, pose, reference::LossKind::Squared));
      // A point within rounding of the image's edge may be counted or not.
      const double most_off = fx == kOddCamera.fx ? 1 : 1e9;
      EXPECT_NEAR(pass.counted()[i], seen.size(), most_off) << "particle " << i;
    }
    return out;
  };
  const auto [least, most] = std::minmax_element(pass.counted().begin(), pass.counted().end());
  EXPECT_LT(*least + 20, *most) << "the overlap must differ for the test to mean something";
  EXPECT_LT(*most, reference_points_.size());
  EXPECT_TRUE(agrees(compare(ranges(kOddCamera.fx), pass.losses()), kWideShare));
  EXPECT_TRUE(differs(compare(ranges(kOddCamera.fx * 1.02), pass.losses())));
}

TEST_F(Fitness, ComparisonSeesAWrongCoefficient) {
  const auto measured = losses(swarm_, 1);
  EXPECT_TRUE(agrees(compare(expected(swarm_), measured), kWideShare));
  EXPECT_TRUE(differs(compare(expected(swarm_, kVolume.voxel_size * 1.002), measured)));
  for (int axis = 0; axis < 6; ++axis) {
    Swarm wrong = swarm_;
    wrong.lengths[axis] *= 1.01;
    EXPECT_TRUE(differs(compare(expected(wrong), measured))) << "axis " << axis;
  }
  Swarm wrong = swarm_;
  wrong.loss = Loss::Absolute;
  EXPECT_TRUE(differs(compare(expected(wrong), measured)));
  wrong = swarm_;
  wrong.centre.translation().y() += 0.001;
  EXPECT_TRUE(differs(compare(expected(wrong), measured)));
  wrong = swarm_;
  wrong.centre.rotate(Eigen::AngleAxisd(0.001, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(differs(compare(expected(wrong), measured)));
  reference_points_.pop_back();  // the normalisation
  EXPECT_TRUE(differs(compare(expected(swarm_), measured)));
}

TEST_F(Fitness, UnobservedAndOutsideSpaceReadAsOne) {
  // Looking from far away, in every direction and through the table, at nothing that was ever seen.
  for (const Eigen::Vector3d& away :
       {Eigen::Vector3d(100, 0, 0), Eigen::Vector3d(-1e4, 0, 0), Eigen::Vector3d(0, 1e6, 0),
        Eigen::Vector3d(0, -30, 0), Eigen::Vector3d(0, 0, 1e7), Eigen::Vector3d(0, 0, -20)}) {
    swarm_.centre.translation() = away;
    for (const float loss : losses(swarm_, 1)) ASSERT_EQ(loss, 1.0f);
  }
  // Half in the model and half out of it is between.
  swarm_.centre = run_->sequence.poses[2];
  swarm_.centre.translation().x() += 1;
  const auto measured = losses(swarm_, 1);
  EXPECT_TRUE(agrees(compare(expected(swarm_), measured), kWideShare));
  EXPECT_LT(measured[0], 1);
  EXPECT_GT(measured[0], 0.3);
}

TEST_F(Fitness, AnEmptyVolumeReadsAsOne) {
  Volume empty(device(), kVolume);
  FitnessPass pass(device(), templates_, Loss::Squared);
  pass.record(run_->recorder, empty, *points_, {.particles = kParticles});
  run_->recorder.submit();
  for (const float loss : pass.losses()) ASSERT_EQ(loss, 1.0f);
}

TEST_F(Fitness, WithoutPointsThereIsNoLoss) {
  const std::vector<std::uint16_t> nothing(run_->sequence.images[0].depth.size(), 0);
  run_->preprocess.record(run_->recorder, nothing, 0.001f, 0.1f, 5.0f);
  points_->record(run_->recorder, run_->preprocess.frame(), kGrid, nullptr);
  run_->recorder.submit();
  for (const std::uint32_t slices : {1u, 5u})
    for (const float loss : losses(swarm_, slices)) ASSERT_LT(loss, 0);
}

}  // namespace test_fitness
}  // namespace rosefusion::testing
