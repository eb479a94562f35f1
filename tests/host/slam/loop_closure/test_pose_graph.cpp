// Pose graphs whose answer is known, and what the optimum must obey.
#include <gtest/gtest.h>

#include <numbers>

#include "host/slam/loop_closure/pose_graph.h"

namespace rosefusion::testing {
namespace test_pose_graph {

constexpr std::size_t kPoses = 24;

/// Around a circle of 2 m, looking ahead; the last pose is the first one's.
std::vector<Pose> circle() {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kPoses; ++i) {
    const double angle = 2 * std::numbers::pi * double(i) / (kPoses - 1);
    poses.push_back(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) *
                    Eigen::Translation3d(2, 0, 0.1 * angle) * Pose::Identity());
  }
  poses.back() = poses.front();
  return poses;
}

/// The motions from pose to pose, each turned and stretched a little too far.
std::vector<PoseEdge> drifting(const std::vector<Pose>& truth, double turn, double stretch) {
  std::vector<PoseEdge> edges;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Pose motion = truth[i - 1].inverse() * truth[i];
    motion.translation() *= 1 + stretch;
    motion.linear() = motion.linear() * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
    edges.push_back({i - 1, i, motion, 0.005, 0.002});
  }
  return edges;
}

std::vector<Pose> chained(const Pose& first, const std::vector<PoseEdge>& edges) {
  std::vector<Pose> poses{first};
  for (const PoseEdge& edge : edges) poses.push_back(poses.back() * edge.first_from_second);
  return poses;
}

double worstShift(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, (a[i].translation() - b[i].translation()).norm());
  return worst;
}

double cost(const std::vector<PoseEdge>& edges, const std::vector<Pose>& poses) {
  double sum = 0;
  for (const PoseEdge& e : edges) {
    const Pose off = e.first_from_second.inverse() * (poses[e.first].inverse() * poses[e.second]);
    const Eigen::Vector3d shift =
        (poses[e.first].inverse() * poses[e.second]).translation() - e.first_from_second.translation();
    const double half = Eigen::AngleAxisd(off.linear()).angle() / 2;
    sum += shift.squaredNorm() / std::pow(e.shift_deviation, 2) +
           std::pow(2 * std::sin(half) / e.turn_deviation, 2);
  }
  return sum;
}

TEST(PoseGraph, MotionsThatAgreeMoveNothing) {
  const std::vector<Pose> truth = circle();
  std::vector<PoseEdge> edges = drifting(truth, 0, 0);
  edges.push_back({0, kPoses - 1, Pose::Identity(), 0.001, 0.001});
  EXPECT_LT(worstShift(optimisePoses(truth, edges), truth), 1e-6);
}

TEST(PoseGraph, ALoopTakesTheDriftOutOfTheWholeWay) {
  const std::vector<Pose> truth = circle();
  std::vector<PoseEdge> edges = drifting(truth, 0.003, 0.02);
  const std::vector<Pose> drifted = chained(truth.front(), edges);
  ASSERT_GT((drifted.back().translation() - truth.back().translation()).norm(), 0.1);
  edges.push_back({0, kPoses - 1, Pose::Identity(), 0.001, 0.0004});
  const std::vector<Pose> closed = optimisePoses(drifted, edges);
  EXPECT_EQ(closed.front().matrix(), truth.front().matrix()) << "the first pose is the world's";
  const std::vector<Pose> again = optimisePoses(drifted, edges);
  for (std::size_t i = 0; i < kPoses; ++i) EXPECT_EQ(again[i].matrix(), closed[i].matrix()) << i;
  EXPECT_LT((closed.back().translation() - truth.back().translation()).norm(), 0.01);
  EXPECT_LT(worstShift(closed, truth), 0.75 * worstShift(drifted, truth)) << "on the way as well";
}

// A minimum of the sum as this file works it out for itself: every small move of every pose makes it larger.
TEST(PoseGraph, TheResultIsAMinimumOfTheWeightedSquares) {
  std::vector<PoseEdge> edges = drifting(circle(), 0.003, 0.02);
  edges.push_back({0, kPoses - 1, Pose::Identity(), 0.002, 0.001});
  const std::vector<Pose> poses = optimisePoses(chained(circle().front(), edges), edges);
  const double least = cost(edges, poses);
  ASSERT_GT(least, 1) << "the motions must contradict each other";
  for (std::size_t i = 1; i < kPoses; ++i)
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        std::vector<Pose> moved = poses;
        const Eigen::Vector3d unit = sign * Eigen::Vector3d::Unit(axis % 3);
        if (axis < 3)
          moved[i].translation() += 1e-4 * unit;
        else
          moved[i].linear() = Eigen::AngleAxisd(1e-4, unit).toRotationMatrix() * moved[i].linear();
        EXPECT_GT(cost(edges, moved), least) << "pose " << i << ", axis " << axis;
      }
}

TEST(PoseGraph, UncertainMotionTakesMostCorrection) {
  std::vector<Pose> line;
  std::vector<PoseEdge> edges;
  for (std::size_t i = 0; i < 5; ++i)
    line.push_back(Eigen::Translation3d(double(i), 0, 0) * Pose::Identity());
  for (std::size_t i = 1; i < 5; ++i)
    edges.push_back({i - 1, i, line[i - 1].inverse() * line[i], 0.01, 0.01});
  edges[2].shift_deviation = 0.1;
  edges.push_back({0, 4, Eigen::Translation3d(4.2, 0, 0) * Pose::Identity(), 0.001, 0.01});
  const std::vector<Pose> poses = optimisePoses(line, edges);
  EXPECT_NEAR(poses[4].translation().x(), 4.2, 0.001);
  // Shares of 0.2 m as the squares of the deviations: 3 x 0.0001 against 0.01.
  EXPECT_NEAR(poses[3].translation().x() - poses[2].translation().x(), 1 + 0.2 * 0.01 / 0.0103, 1e-3);
}

}  // namespace test_pose_graph
}  // namespace rosefusion::testing
