// The path that the viewer draws, from results of frames as the pipeline gives them; no device is needed.
#include <gtest/gtest.h>

#include "apps/viewer/shown_path.h"

namespace rosefusion::testing {
namespace test_shown_path {
using namespace viewer;

Pose at(double x, double turn = 0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

FrameResult found(double timestamp, const Pose& pose) {
  FrameResult result;
  result.timestamp = timestamp;
  result.world_from_camera = pose;
  result.status = TrackingStatus::Tracked;
  return result;
}

FrameResult lost(double timestamp) {
  FrameResult result;
  result.timestamp = timestamp;
  return result;
}

Trajectory posesAt(const std::vector<double>& positions) {
  Trajectory out;
  for (const double x : positions) out.push_back({static_cast<double>(out.size()), at(x)});
  return out;
}

std::vector<double> positionsOf(const ShownPath& path) {
  std::vector<double> out;
  for (const PathPoint& p : path.points()) out.push_back(p.position.x());
  return out;
}

using Positions = std::vector<double>;

TEST(ShownPath, SpeedsAreOfSecondsAndEndWhereAFrameIsLost) {
  ShownPath path;
  path.add(found(0, at(0)), {}, 0.1);
  EXPECT_EQ(path.speed(), 0) << "nothing lies before it";
  EXPECT_FALSE(path.points()[0].connected);
  path.add(found(2, at(0.5, 0.3)), {}, 0.1);
  EXPECT_NEAR(path.speed(), 2.5, 1e-9);
  EXPECT_NEAR(path.turnRate(), 1.5, 1e-9);
  EXPECT_NEAR(path.points()[1].speed, 2.5, 1e-9);
  EXPECT_TRUE(path.points()[1].connected);
  path.add(lost(3), {}, 0.1);
  EXPECT_EQ(path.speed(), 0);
  EXPECT_EQ(path.points().size(), 2u);
  EXPECT_FALSE(path.last());
  path.add(found(4, at(1)), {}, 0.1);
  EXPECT_EQ(path.speed(), 0);
  EXPECT_FALSE(path.points()[2].connected) << "a line across the loss would be a guess";
}

TEST(ShownPath, ALoopMovesAllPoints) {
  ShownPath path;
  for (int i = 0; i < 3; ++i) path.add(found(i, at(i)), {}, 1);
  FrameResult closing = found(3, at(2.7));
  closing.loop = LoopClosure{};
  path.add(closing, posesAt({0, 0.9, 1.8, 2.7}), 1);
  EXPECT_EQ(positionsOf(path), (Positions{0, 0.9, 1.8, 2.7}));
  EXPECT_NEAR(path.speed(), 0.9, 1e-9) << "from where the frame before is now";
}

TEST(ShownPath, RecoveredPosesComeWhereTheirNumberSays) {
  ShownPath path;
  path.add(found(0, at(0)), {}, 1);
  path.add(lost(1), {}, 1);
  FrameResult result = found(3, at(3));
  result.recovered = {{1, {1, at(1)}, Reason::ConfirmedLater}, {2, {2, at(2)}, Reason::ConfirmedLater}};
  path.add(result, {}, 1);
  EXPECT_EQ(positionsOf(path), (Positions{0, 1, 2, 3}));
}

TEST(ShownPath, AModelThatBeginsAnewLeavesTheFrameBefore) {
  ShownPath path;
  for (int i = 0; i < 3; ++i) path.add(found(i, at(i)), {}, 1);
  path.add(lost(3), {}, 1);
  FrameResult anew = found(4, at(0.5));
  anew.began_anew = true;
  path.add(anew, {}, 1);
  EXPECT_EQ(positionsOf(path), (Positions{0, 0.5}));
  EXPECT_NEAR(path.speed(), 0.5, 1e-9) << "since the lost frame, which is the model's first now";
}

TEST(ShownPath, CorrectionsReachNoFurtherThanEitherList) {
  ShownPath path;
  EXPECT_FALSE(path.correct(posesAt({1})));
  for (int i = 0; i < 2; ++i) path.add(found(i, at(i)), {}, 1);
  EXPECT_FALSE(path.correct({}));
  EXPECT_TRUE(path.correct(posesAt({5})));
  EXPECT_EQ(positionsOf(path), (Positions{5, 1}));
  EXPECT_TRUE(path.correct(posesAt({6, 7, 8})));
  EXPECT_EQ(positionsOf(path), (Positions{6, 7}));
  ASSERT_TRUE(path.last());
  EXPECT_EQ(path.last()->world_from_camera.translation().x(), 7);
}

}  // namespace test_shown_path
}  // namespace rosefusion::testing
