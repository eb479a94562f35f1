// The rules of pfo's and pso's updates, each by itself, and that both find the optimum of a smooth loss.
#include "host/slam/baselines/free_swarm.h"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

namespace rosefusion::testing {
namespace test_free_swarm {

constexpr double kExact = 1e-12;

SwarmSettings settingsOf(std::vector<SwarmLevel> levels) {
  SwarmSettings settings;
  settings.loss = FitnessLoss::Absolute;
  settings.levels = std::move(levels);
  settings.max_empty_sets = 1000;
  settings.minimum_move = 0;
  return settings;
}

SwarmTemplate lineTemplate(int particles) {
  SwarmTemplate out;
  for (int i = 0; i < particles; ++i)
    out.particles.push_back({static_cast<float>(i) / static_cast<float>(particles), 0, 0, 0, 0, 0});
  return out;
}

SwarmTemplate ballTemplate(int particles, std::uint64_t seed) {
  PortableRandom random(seed);
  SwarmTemplate out;
  out.particles.push_back({});
  while (static_cast<int>(out.particles.size()) < particles) {
    const Point6 direction = random.direction();
    const double radius = random.ballRadius();
    Particle p;
    for (int axis = 0; axis < 6; ++axis) p[axis] = static_cast<float>(radius * direction[axis]);
    out.particles.push_back(p);
  }
  return out;
}

Pose somePose() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(1, -2, 3))
      .rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
  return pose;
}

TEST(FreeSwarm, BeginsWhereTheTemplateSearchDoes) {
  const SwarmSettings settings = settingsOf({{64, 8}, {32, 4}});
  const SwarmTemplate first = ballTemplate(64, 3);
  const FreeSwarm swarm = beginFreeSwarm(settings, somePose(), first, nullptr);
  const SwarmState search = beginFrame(settings, somePose(), nullptr);
  ASSERT_EQ(swarm.particles.size(), 64u);
  EXPECT_EQ(swarm.evaluated(settings), 64u);
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_EQ(swarm.particles[i], scaledParticle(first, i, search.axis_lengths));
  EXPECT_TRUE(swarm.state.centre.isApprox(somePose(), 0));
}

TEST(FreeSwarm, TheBestParticleBecomesTheCentre) {
  const SwarmSettings settings = settingsOf({{4, 8}});
  PortableRandom random(1);
  FreeSwarm swarm = beginFreeSwarm(settings, somePose(), lineTemplate(4), nullptr);
  const Vector6 best = swarm.particles[2];
  const SwarmStep step =
      updatePso(settings, {}, swarm, std::vector<float>{0.5f, 0.4f, 0.1f, 0.7f}, {}, random);
  EXPECT_EQ(step.advantage, 2);
  EXPECT_EQ(swarm.particles[0], best);
  EXPECT_EQ(step.move, best);
  EXPECT_TRUE(swarm.state.centre.isApprox(moveBy(somePose(), best), kExact));
  EXPECT_NEAR(step.likelihood_before, 0.5, 1e-6);
  EXPECT_NEAR(step.likelihood_after, 0.9, 1e-6);
}

TEST(FreeSwarm, NothingBetterKeepsTheCentre) {
  SwarmSettings settings = settingsOf({{4, 8}, {4, 4}});
  settings.max_empty_sets = 2;
  settings.max_iterations = 3;
  for (const bool pfo : {true, false}) {
    PortableRandom random(1);
    FreeSwarm swarm = beginFreeSwarm(settings, somePose(), lineTemplate(4), nullptr);
    const std::vector<float> losses{0.1f, 0.4f, 0.2f, 0.1f};
    for (int i = 0; i < 3; ++i) {
      ASSERT_FALSE(swarm.state.stopped());
      EXPECT_EQ(swarm.state.level, static_cast<std::size_t>(i % 2));
      pfo ? updatePfo(settings, {}, swarm, losses, {}, random)
          : updatePso(settings, {}, swarm, losses, {}, random);
      EXPECT_TRUE(swarm.state.centre.isApprox(somePose(), 0));
    }
    EXPECT_EQ(swarm.state.stop_reason, StopReason::MaxIterations);
    EXPECT_NEAR(swarm.state.failure_loss, 0.1, 1e-6);
    EXPECT_THROW(updatePfo(settings, {}, swarm, losses, {}, random), std::invalid_argument);
  }
}

TEST(FreeSwarm, ParticlesThatDoNotCountNeitherWinNorPass) {
  const SwarmSettings settings = settingsOf({{4, 8}});
  PortableRandom random(1);
  FreeSwarm swarm = beginFreeSwarm(settings, Pose::Identity(), lineTemplate(4), nullptr);
  // The third was counted over too few pixels, the second over none.
  const SwarmStep step = updatePfo(settings, {0, 0, 1e-3}, swarm, std::vector<float>{0.5f, -1, 0.1f, 0.4f},
                                   std::vector<uint32_t>{100, 0, 20, 90}, random);
  EXPECT_EQ(step.counted, 2);
  EXPECT_EQ(step.advantage, 1);
  for (const Vector6& p : swarm.particles) EXPECT_NEAR(p[0], 0.75 * 0.5, kExact);
}

TEST(FreeSwarm, PfoResamplesByWeightAndSpreads) {
  const SwarmSettings settings = settingsOf({{4, 8}, {4001, 4}});
  PortableRandom random(7);
  FreeSwarm swarm = beginFreeSwarm(settings, Pose::Identity(), lineTemplate(4), nullptr);
  const std::vector<Vector6> before = swarm.particles;
  // Of the last two, the better is e times as likely: temperature 0.1, losses 0.1 apart. The first is
  // replaced by the best, the second hopeless.
  updatePfo(settings, {0.001, 0, 0.1}, swarm, std::vector<float>{1.0f, 1.0f, 0.2f, 0.1f}, {}, random);
  ASSERT_EQ(swarm.particles.size(), 4001u) << "as many as the next level evaluates";
  int better = 0, worse = 0;
  double spread = 0;
  for (std::size_t i = 1; i < swarm.particles.size(); ++i) {
    const double from_worse = swarm.particles[i][0] - before[2][0],
                 from_better = swarm.particles[i][0] - before[3][0];
    (std::abs(from_better) < std::abs(from_worse) ? better : worse)++;
    spread += std::pow(std::min(std::abs(from_better), std::abs(from_worse)), 2);
    EXPECT_EQ(swarm.particles[i][4], 0) << "no deviation was asked for on this axis";
  }
  EXPECT_NEAR(better / static_cast<double>(worse), std::exp(1), 0.01);
  EXPECT_NEAR(std::sqrt(spread / 4000), 0.001, 0.0001);
}

TEST(FreeSwarm, PsoPullsTowardsTheOwnBestAndTheSwarms) {
  const SwarmSettings settings = settingsOf({{3, 8}});
  PortableRandom random(5), same(5);
  FreeSwarm swarm = beginFreeSwarm(settings, Pose::Identity(), lineTemplate(3), nullptr);
  swarm.velocities[1] = Vector6::Constant(0.2);
  swarm.own_best_fitness[1] = 0.95;  // better than what it finds now
  swarm.own_best[1] = Vector6::Constant(0.7);
  const std::vector<Vector6> before = swarm.particles;
  const PsoSettings pso{0.5, 1.5, 2.0};
  updatePso(settings, pso, swarm, std::vector<float>{0.5f, 0.4f, 0.2f}, {}, random);
  for (int axis = 0; axis < 6; ++axis) {
    const double own = same.uniform(), all = same.uniform();
    const double velocity =
        0.5 * 0.2 + 1.5 * own * (0.7 - before[1][axis]) + 2.0 * all * (before[2][axis] - before[1][axis]);
    EXPECT_NEAR(swarm.velocities[1][axis], velocity, kExact);
    EXPECT_NEAR(swarm.particles[1][axis], before[1][axis] + velocity, kExact);
  }
  EXPECT_EQ(swarm.own_best[2], before[2]);
  EXPECT_EQ(swarm.particles[2], before[2]) << "the best has nowhere to be pulled";
}

TEST(FreeSwarm, PsoParticlesBeyondTheLevelWait) {
  const SwarmSettings settings = settingsOf({{2, 8}, {4, 4}});
  PortableRandom random(5);
  FreeSwarm swarm = beginFreeSwarm(settings, Pose::Identity(), lineTemplate(4), nullptr);
  const std::vector<Vector6> before = swarm.particles;
  EXPECT_EQ(swarm.evaluated(settings), 2u);
  EXPECT_THROW(updatePso(settings, {}, swarm, std::vector<float>(4, 0.5f), {}, random),
               std::invalid_argument);
  updatePso(settings, {}, swarm, std::vector<float>{0.5f, 0.4f}, {}, random);
  EXPECT_EQ(swarm.particles[2], before[2]);
  EXPECT_EQ(swarm.evaluated(settings), 4u);
}

TEST(FreeSwarm, BothFindASmoothOptimumRepeatably) {
  const SwarmSettings settings = settingsOf({{512, 8}});
  Vector6 optimum;
  optimum << 0.08, -0.05, 0.03, 0.02, -0.04, 0.01;
  const auto search = [&](bool pfo) {
    PortableRandom random(11);
    FreeSwarm swarm = beginFreeSwarm(settings, somePose(), ballTemplate(512, 3), nullptr);
    while (!swarm.state.stopped()) {
      std::vector<float> losses;
      for (const Vector6& p : swarm.particles) losses.push_back(static_cast<float>((p - optimum).norm()));
      pfo ? updatePfo(settings, {}, swarm, losses, {}, random)
          : updatePso(settings, {}, swarm, losses, {}, random);
    }
    EXPECT_EQ(swarm.state.iteration, settings.max_iterations);
    return swarm.particles[0];
  };
  for (const bool pfo : {true, false}) {
    EXPECT_LT((search(pfo) - optimum).norm(), 0.02) << (pfo ? "pfo" : "pso");
    EXPECT_EQ(search(pfo), search(pfo));
  }
}

}  // namespace test_free_swarm
}  // namespace rosefusion::testing
