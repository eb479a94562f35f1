#include "host/evaluation/association.h"

#include <gtest/gtest.h>

#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_association {

Trajectory at(const std::vector<double>& stamps) {
  Trajectory trajectory;
  for (const double t : stamps)
    trajectory.push_back({t, makePose({t, 0, 0}, 0, {1, 0, 0})});  // x tells the stamp
  return trajectory;
}

/// The stamps of the true poses that were paired, in order.
std::vector<double> paired(const Trajectory& estimate, const Trajectory& truth, Association association,
                           double max_difference_s) {
  std::vector<double> stamps;
  for (const PosePair& p : associate(estimate, truth, association, max_difference_s))
    stamps.push_back(p.truth.translation().x());
  return stamps;
}

using Stamps = std::vector<double>;

TEST(AssociateNearest, TakesTheNearestWithinTheLimit) {
  EXPECT_EQ(paired(at({1.0, 2.0, 3.0}), at({0.99, 1.006, 2.03, 3.015}), Association::Nearest, 0.02),
            (Stamps{1.006, 3.015}));
}

TEST(AssociateNearest, TheLimitItselfCounts) {
  EXPECT_EQ(paired(at({1.0}), at({1.25}), Association::Nearest, 0.25), Stamps{1.25});
}

TEST(AssociateNearest, IsOneToOneAndTheCloserOneWins) {
  EXPECT_EQ(paired(at({1.0, 1.01}), at({1.009}), Association::Nearest, 0.02), Stamps{1.009});
  const auto pairs = associate(at({1.0, 1.01}), at({1.009}), Association::Nearest, 0.02);
  EXPECT_EQ(pairs.at(0).timestamp, 1.01);
  // The loser takes the next best that is free.
  EXPECT_EQ(paired(at({1.0, 1.01}), at({0.985, 1.009}), Association::Nearest, 0.02), (Stamps{0.985, 1.009}));
}

TEST(AssociateNearest, HoldsForDuplicatedStamps) {
  EXPECT_EQ(paired(at({1, 1, 1}), at({1, 1}), Association::Nearest, 0.02).size(), 2u);
}

TEST(AssociateNearest, NothingFromNothing) {
  EXPECT_TRUE(paired({}, at({1}), Association::Nearest, 0.02).empty());
  EXPECT_TRUE(paired(at({1}), {}, Association::Nearest, 0.02).empty());
}

TEST(AssociateInterpolated, ReadsTheTruthAtTheEstimatesStamps) {
  const auto stamps = paired(at({1.003, 1.017}), at({1.0, 1.01, 1.02}), Association::Interpolated, 0.02);
  ASSERT_EQ(stamps.size(), 2u);
  EXPECT_NEAR(stamps[0], 1.003, 1e-12);
  EXPECT_NEAR(stamps[1], 1.017, 1e-12);
}

TEST(AssociateInterpolated, StopsAtGapsAndEnds) {
  EXPECT_EQ(paired(at({0.995, 1.0, 1.5, 2.0, 2.005}), at({1.0, 2.0}), Association::Interpolated, 0.02),
            (Stamps{1.0, 2.0}));
  EXPECT_TRUE(paired(at({1.0}), {}, Association::Interpolated, 0.02).empty());
}

}  // namespace test_association
}  // namespace rosefusion::testing
