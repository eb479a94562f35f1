#include "host/evaluation/alignment.h"

#include <gmock/gmock.h>

#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_alignment {

using ::testing::HasSubstr;

std::vector<PosePair> pairsOf(const Trajectory& estimate, const Trajectory& truth) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    pairs.push_back({estimate[i].timestamp, estimate[i].world_from_camera, truth[i].world_from_camera});
  return pairs;
}

/// `position(i)` for ten frames, with orientations that turn.
template <class Position>
Trajectory turning(Position&& position) {
  Trajectory trajectory;
  for (int i = 0; i < 10; ++i)
    trajectory.push_back({0.1 * i, makePose(position(i), 0.1 * i, {1, 0.3, -0.2})});
  return trajectory;
}

TEST(AlignPoses, FindsARigidMotion) {
  const Trajectory estimate = curve(50);
  const Alignment a = alignPoses(pairsOf(estimate, moved(somewhere(), estimate)));
  EXPECT_TRUE(a.positions_suffice);
  EXPECT_TRUE(a.truth_from_estimate.isApprox(somewhere(), 1e-12));
  EXPECT_THAT(a.description, HasSubstr("Umeyama"));
}

TEST(AlignPoses, DoesNotScale) {
  const Trajectory truth = curve(50);
  Trajectory estimate = truth;
  for (StampedPose& p : estimate) p.world_from_camera.translation() *= 0.5;
  EXPECT_TRUE(isProperRotation(alignPoses(pairsOf(estimate, truth)).truth_from_estimate.linear()));
}

TEST(AlignPoses, MirroredTrajectoryGivesAProperRotation) {
  const Trajectory truth = curve(50);
  Trajectory estimate = truth;
  for (StampedPose& p : estimate) p.world_from_camera.translation().z() *= -1;
  EXPECT_TRUE(isProperRotation(alignPoses(pairsOf(estimate, truth)).truth_from_estimate.linear()));
}

TEST(AlignPoses, PlanarMotionNeedsNoOrientations) {
  Trajectory estimate = turning([](int i) { return Eigen::Vector3d(i, 0.1 * i * i, 0); });
  Trajectory truth = moved(somewhere(), estimate);
  for (StampedPose& p : estimate) p.world_from_camera.linear().setIdentity();
  const Alignment a = alignPoses(pairsOf(estimate, truth));
  EXPECT_TRUE(a.positions_suffice);
  EXPECT_TRUE(a.truth_from_estimate.isApprox(somewhere(), 1e-9));
}

TEST(AlignPoses, StraightMotionTakesRollFromOrientations) {
  const Trajectory estimate = turning([](int i) { return Eigen::Vector3d(0.3 * i, -0.1 * i, 0.2 * i); });
  const Alignment a = alignPoses(pairsOf(estimate, moved(somewhere(), estimate)));
  EXPECT_FALSE(a.positions_suffice);
  EXPECT_TRUE(a.truth_from_estimate.isApprox(somewhere(), 1e-6));
  EXPECT_THAT(a.description, HasSubstr("straight line"));
}

TEST(AlignPoses, StraightMotionOutweighsOrientations) {
  const Trajectory estimate = turning([](int i) { return Eigen::Vector3d(0.3 * i, 0, 0); });
  Trajectory truth = moved(somewhere(), estimate);
  for (StampedPose& p : truth)  // say, a camera mounted tilted
    p.world_from_camera.linear() = p.world_from_camera.linear() * makePose({}, 0.5, {0, 1, 0}).linear();
  const Pose found = alignPoses(pairsOf(estimate, truth)).truth_from_estimate;
  EXPECT_TRUE(isProperRotation(found.linear()));
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT((found * estimate[i].world_from_camera.translation() - truth[i].world_from_camera.translation())
                  .norm(),
              1e-6);
}

TEST(AlignPoses, TurnOnTheSpotIsAlignedByOrientations) {
  const Trajectory estimate = turning([](int) { return Eigen::Vector3d(1, 2, 3); });
  const Alignment a = alignPoses(pairsOf(estimate, moved(somewhere(), estimate)));
  EXPECT_FALSE(a.positions_suffice);
  EXPECT_TRUE(a.truth_from_estimate.isApprox(somewhere(), 1e-9));
  EXPECT_THAT(a.description, HasSubstr("do not move"));
}

TEST(AlignPoses, OneOrTwoPosesGiveAProperRotation) {
  for (const std::size_t n : {1u, 2u}) {
    const Trajectory estimate = curve(n);
    const Alignment a = alignPoses(pairsOf(estimate, moved(somewhere(), estimate)));
    EXPECT_FALSE(a.positions_suffice);
    EXPECT_TRUE(a.truth_from_estimate.isApprox(somewhere(), 1e-6)) << n;
  }
}

TEST(AlignPoses, NoPairsGiveTheIdentity) {
  const Alignment a = alignPoses({});
  EXPECT_TRUE(a.truth_from_estimate.matrix().isIdentity());
  EXPECT_THAT(a.description, HasSubstr("not aligned"));
}

TEST(AlignPoses, LeverOutweighsTinyNoisyMotion) {
  // A turn on the spot in which the estimated positions are nothing but millimetres of noise.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.002);
  const auto jitter = [&](int) { return Eigen::Vector3d(noise(random), noise(random), noise(random)); };
  Trajectory estimate = turning(jitter), truth = moved(somewhere(), turning(jitter));
  const auto angleOff = [&](double lever_m) {
    const Pose found = alignPoses(pairsOf(estimate, truth), lever_m).truth_from_estimate;
    return rotationAngle(found.inverse() * somewhere());
  };
  EXPECT_GT(angleOff(0), 0.1);
  EXPECT_LT(angleOff(1), 1e-3);
}

}  // namespace test_alignment
}  // namespace rosefusion::testing
