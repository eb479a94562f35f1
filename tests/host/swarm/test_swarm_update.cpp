// Each rule of the update by itself, with numbers small enough to check by hand.
#include "host/swarm/swarm_update.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "host/core/error.h"

namespace rosefusion::testing {
namespace test_swarm_update {

using ::testing::HasSubstr;

constexpr double kExact = 1e-12;  // rounding of a few operations on numbers of order one
constexpr double kSingle = 1e-6;  // losses and particles come in as floats

SwarmTemplate templateOf(std::vector<Particle> particles) {
  particles.insert(particles.begin(), Particle{});
  return {std::move(particles), 0.1};
}

// A search in which fitness is 1 - loss, so that the numbers are round.
SwarmSettings roundNumbers() {
  SwarmSettings settings;
  settings.loss = FitnessLoss::Absolute;
  return settings;
}

SwarmState atIdentity(const SwarmSettings& settings) {
  return beginFrame(settings, Pose::Identity(), nullptr);
}

Pose somePose() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(1, -2, 3))
      .rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
  return pose;
}

TEST(MoveBy, AddsInWorldAxesAndTurnsFromTheLeft) {
  Vector6 move;
  move << 0.1, 0.2, 0.3, 0, 0, std::sin(M_PI / 4);  // a quarter turn about the world's z
  const Pose moved = moveBy(somePose(), move);
  EXPECT_TRUE(moved.translation().isApprox(Eigen::Vector3d(1.1, -1.8, 3.3), kExact));
  const Eigen::Vector3d x = somePose().linear() * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(
      (moved.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(-x.y(), x.x(), x.z()), kExact));
}

TEST(MoveBy, ClampsLongImaginaryPartsToAHalfTurn) {
  Vector6 move = Vector6::Zero();
  move[4] = 1.7;
  const Pose moved = moveBy(Pose::Identity(), move);
  EXPECT_TRUE(moved.linear().isApprox(Eigen::Vector3d(-1, 1, -1).asDiagonal().toDenseMatrix(), kExact));
}

TEST(MoveBy, KeepsTheRotationOrthonormalOverManyMoves) {
  Pose pose = somePose();
  Vector6 move;
  move << 0, 0, 0, 0.3, -0.2, 0.1;
  for (int i = 0; i < 100000; ++i) pose = moveBy(pose, move);
  EXPECT_NEAR((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0, kExact);
}

TEST(SwarmUpdate, AveragesTheAdvantageSetByFitnessGain) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = atIdentity(settings);
  state.axis_lengths = Vector6::Constant(0.4);
  // Gains 0.3 and 0.1; the third is worse than particle 0 and the fourth just as good.
  const auto swarm =
      templateOf({{0.5f, 0, 0, 0, 0, 0}, {0, 0.5f, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}, {0, 0, -1, 0, 0, 0}});
  const SwarmStep step = update(settings, state, swarm, std::vector<float>{0.5f, 0.2f, 0.4f, 0.6f, 0.5f});
  EXPECT_EQ(step.advantage, 2);
  EXPECT_EQ(step.counted, 5);
  EXPECT_NEAR(step.likelihood_before, 0.5, kSingle);
  EXPECT_NEAR(step.likelihood_after, 0.75 * 0.8 + 0.25 * 0.6, kSingle);  // [eq. wafit]
  EXPECT_TRUE(state.centre.translation().isApprox(Eigen::Vector3d(0.15, 0.05, 0), kSingle));
  // r^ = 0.25 (0.15, 0.05) / 0.158114 + 0.001, r = 0.1 * 0.4 + 0.9 r^ [eqs. rsinter, momentum]
  EXPECT_NEAR(state.axis_lengths[0], 0.04 + 0.9 * (0.25 * 0.948683298 + 0.001), kSingle);
  EXPECT_NEAR(state.axis_lengths[1], 0.04 + 0.9 * (0.25 * 0.316227766 + 0.001), kSingle);
  EXPECT_NEAR(state.axis_lengths[5], 0.04 + 0.9 * 0.001, kSingle);
}

TEST(SwarmUpdate, AxisLengthsAreMagnitudesOfTheMove) {
  const SwarmSettings settings = roundNumbers();
  SwarmState forwards = atIdentity(settings), backwards = atIdentity(settings);
  update(settings, forwards, templateOf({{0.5f, 0, 0.2f, 0, 0.3f, 0}}), std::vector<float>{0.5f, 0.2f});
  update(settings, backwards, templateOf({{-0.5f, 0, -0.2f, 0, -0.3f, 0}}), std::vector<float>{0.5f, 0.2f});
  EXPECT_TRUE(forwards.axis_lengths.isApprox(backwards.axis_lengths, kExact));
  EXPECT_GT(backwards.axis_lengths.minCoeff(), 0);
}

TEST(SwarmUpdate, RenormalisesTheMeanQuaternion) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = atIdentity(settings);
  state.axis_lengths = Vector6::Ones();
  const auto swarm = templateOf({{0, 0, 0, 0.6f, 0, 0}, {0, 0, 0, 0, 0.6f, 0}});
  const SwarmStep step = update(settings, state, swarm, std::vector<float>{0.5f, 0.4f, 0.4f});
  // Mean of (0.8, 0.6, 0, 0) and (0.8, 0, 0.6, 0) is (0.8, 0.3, 0.3, 0), of length sqrt(0.82).
  EXPECT_NEAR(step.move[3], 0.3 / std::sqrt(0.82), kSingle);
  EXPECT_NEAR(step.move[4], 0.3 / std::sqrt(0.82), kSingle);
  EXPECT_NEAR(rotationAngle(state.centre), 2 * std::acos(0.8 / std::sqrt(0.82)), kSingle);
}

// Averaging moves relative to the centre must be averaging the particles' poses, whatever the centre is.
TEST(SwarmUpdate, MeanMoveIsTheMeanOfThePoses) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = beginFrame(settings, somePose(), nullptr);
  const auto swarm = templateOf({{0.5f, 0.1f, 0, 0.6f, 0.1f, 0}, {-0.2f, 0, 0.3f, 0, -0.5f, 0.4f}});
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  const Eigen::Vector4d centre = Eigen::Quaterniond(somePose().linear()).coeffs();
  for (const auto& [index, weight] : {std::pair<size_t, double>{1, 0.3}, {2, 0.1}}) {
    const Pose pose = moveBy(state.centre, scaledParticle(swarm, index, state.axis_lengths));
    const Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    sum += weight * (q.dot(centre) < 0 ? -q : q);
  }
  update(settings, state, swarm, std::vector<float>{0.5f, 0.2f, 0.4f});
  const Eigen::Quaterniond expected(sum.normalized());
  EXPECT_NEAR(expected.angularDistance(Eigen::Quaterniond(state.centre.linear())), 0, kSingle);
}

TEST(SwarmUpdate, AnEmptyAdvantageSetMakesASphere) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = beginFrame(settings, somePose(), nullptr);
  state.axis_lengths << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  const Vector6 before = state.axis_lengths;
  const SwarmStep step =
      update(settings, state, templateOf({{1, 0, 0, 0, 0, 0}}), std::vector<float>{0.3f, 0.31f});
  EXPECT_EQ(step.advantage, 0);
  EXPECT_TRUE(state.centre.isApprox(somePose(), kExact));
  const double sphere = 2 * 0.3 / 2.449489743;  // no epsilon in this case
  EXPECT_TRUE(state.axis_lengths.isApprox(0.1 * before + Vector6::Constant(0.9 * sphere), kSingle));
  EXPECT_EQ(state.empty_sets_in_a_row, 1);
}

TEST(SwarmUpdate, IsASphereWhereNothingIsMeasured) {
  const SwarmSettings settings;
  SwarmState state = atIdentity(settings);
  EXPECT_TRUE(state.axis_lengths.isApprox(Vector6::Constant(0.5), kExact));
  EXPECT_EQ(state.best_likelihood, 0.5);
  state.axis_lengths = Vector6::Constant(0.02);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SwarmStep step =
      update(settings, state, templateOf({{1, 0, 0, 0, 0, 0}}), std::vector<float>{nan, 0.1f});
  EXPECT_EQ(step.advantage, 0);  // nothing to compare the other particle with
  EXPECT_TRUE(state.axis_lengths.isApprox(Vector6::Constant(0.1 * 0.02 + 0.9 * 0.5), kExact));
  EXPECT_EQ(step.likelihood_after, 0.5);
}

TEST(SwarmUpdate, UncountedParticlesNeverWin) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = atIdentity(settings);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto swarm = templateOf({{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}});
  const SwarmStep step = update(settings, state, swarm, std::vector<float>{0.5f, nan, -1, 0.4f});
  EXPECT_EQ(step.counted, 2);
  EXPECT_EQ(step.advantage, 1);
  EXPECT_TRUE(state.centre.translation().isApprox(Eigen::Vector3d(0, 0, 0.5), kSingle));
}

TEST(SwarmUpdate, AParticleNeedsOverHalfTheBestsPixels) {
  const SwarmSettings settings = roundNumbers();
  SwarmState state = atIdentity(settings);
  const auto swarm = templateOf({{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}});
  const SwarmStep step = update(settings, state, swarm, std::vector<float>{0.5f, 0.1f, 0.4f},
                                std::vector<uint32_t>{100, 50, 51});
  EXPECT_EQ(step.advantage, 1);
  EXPECT_NEAR(state.centre.translation().x(), 0, kExact);
}

TEST(SwarmUpdate, AveragesTheFirstParticlesWhenLimited) {
  SwarmSettings settings = roundNumbers();
  settings.max_advantage_particles = 2;
  SwarmState state = atIdentity(settings);
  const auto swarm = templateOf({{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}});
  const SwarmStep step = update(settings, state, swarm, std::vector<float>{0.5f, 0.4f, 0.4f, 0.1f});
  EXPECT_EQ(step.advantage, 2);
  EXPECT_TRUE(state.centre.translation().isApprox(Eigen::Vector3d(0.25, 0.25, 0), kSingle));
}

TEST(SwarmUpdate, UsesLevelsInTurnAndRestarts) {
  const auto swarm = templateOf({{0.5f, 0, 0, 0, 0, 0}});
  const std::vector<float> better = {0.5f, 0.4f}, worse = {0.5f, 0.6f};
  for (const bool restart : {true, false}) {
    SwarmSettings settings = roundNumbers();
    settings.restart_levels_when_empty = restart;
    SwarmState state = atIdentity(settings);
    std::vector<size_t> levels;
    for (const auto& losses : {better, better, better, better, worse, better}) {
      levels.push_back(state.level);
      EXPECT_EQ(update(settings, state, swarm, losses).level, levels.back());
    }
    levels.push_back(state.level);
    EXPECT_EQ(levels, (restart ? std::vector<size_t>{0, 1, 2, 0, 1, 0, 1}
                               : std::vector<size_t>{0, 1, 2, 0, 1, 2, 0}));
  }
}

TEST(SwarmUpdate, StopsByThePapersCriteria) {
  SwarmSettings settings = roundNumbers();
  const auto swarm = templateOf({{0.5f, 0, 0, 0, 0, 0}});
  const auto run = [&](const std::vector<std::vector<float>>& losses) {
    SwarmState state = atIdentity(settings);
    for (const auto& l : losses)
      if (!state.stopped()) update(settings, state, swarm, l);
    return std::pair(state.stop_reason, state.iteration);
  };
  const std::vector<float> better = {0.5f, 0.4f}, worse = {0.5f, 0.6f};
  EXPECT_EQ(run({worse, better, worse}), std::pair(StopReason::None, 3));  // not in a row
  EXPECT_EQ(run({better, worse, worse}), std::pair(StopReason::EmptySets, 3));
  EXPECT_EQ(run(std::vector(25, better)), std::pair(StopReason::MaxIterations, 20));
  settings.minimum_move = 0.26;  // the first move is 0.25, the sphere's radius 0.5 times 0.5
  EXPECT_EQ(run({better}), std::pair(StopReason::SmallMove, 1));
  settings.minimum_move = 0.24;
  EXPECT_EQ(run({better}), std::pair(StopReason::None, 1));
}

TEST(SwarmUpdate, AMoveBelowAMillionthEndsTheSearch) {
  const SwarmSettings settings = roundNumbers();
  for (const auto& [length, reason] :
       {std::pair{0.9e-6f, StopReason::SmallMove}, {1.1e-6f, StopReason::None}}) {
    SwarmState state = atIdentity(settings);
    state.axis_lengths = Vector6::Ones();
    EXPECT_EQ(update(settings, state, templateOf({{0, 0, 0, 0, 0, length}}), std::vector<float>{0.5f, 0.4f})
                  .stop_reason,
              reason);
  }
}

TEST(BeginFrame, TakesLengthsOfTheLastFirstIteration) {
  const SwarmSettings settings = roundNumbers();
  const auto swarm = templateOf({{0.5f, 0, 0, 0, 0, 0}});
  SwarmState last = atIdentity(settings);
  const Vector6 first = update(settings, last, swarm, std::vector<float>{0.5f, 0.4f}).axis_lengths;
  update(settings, last, swarm, std::vector<float>{0.4f, 0.1f});
  const SwarmState next = beginFrame(settings, somePose(), &last);
  EXPECT_TRUE(next.axis_lengths.isApprox(first, kExact));
  EXPECT_FALSE(next.axis_lengths.isApprox(last.axis_lengths, 1e-3));
  EXPECT_TRUE(next.centre.isApprox(somePose(), kExact));
  EXPECT_EQ(next.iteration, 0);
  EXPECT_EQ(next.level, 0u);
  EXPECT_EQ(next.serial, 2u);  // goes on, so that every template gets its turn
}

TEST(BeginFrame, TheReleaseStartsFromTheLastLoss) {
  const SwarmSettings settings = releaseSwarmSettings();
  const auto swarm = templateOf({{0.5f, 0, 0, 0, 0, 0}});
  SwarmState last = atIdentity(settings);
  EXPECT_NEAR(last.axis_lengths[0], 0.18 * 0.5, kExact);
  for (const float loss : {0.2f, 0.1f}) update(settings, last, swarm, std::vector<float>{loss, loss});
  EXPECT_TRUE(
      beginFrame(settings, somePose(), &last).axis_lengths.isApprox(Vector6::Constant(0.18 * 0.2), kSingle));
}

TEST(PixelOffset, VisitsEveryPixelOfEveryLevel) {
  const SwarmSettings settings;
  for (size_t level = 0; level < settings.levels.size(); ++level) {
    const int stride = settings.levels[level].pixel_stride;
    std::set<std::pair<int, int>> seen;
    SwarmState state = atIdentity(settings);
    state.level = level;
    // Used in turn, a level sees every third number.
    for (int i = 0; i < stride * stride; ++i, state.serial += 3) {
      const Eigen::Vector2i offset = pixelOffset(settings, state);
      ASSERT_TRUE(offset.minCoeff() >= 0 && offset.maxCoeff() < stride);
      seen.insert({offset.x(), offset.y()});
    }
    EXPECT_EQ(seen.size(), static_cast<size_t>(stride * stride));
  }
}

TEST(SwarmUpdate, RefusesMismatchedInputAndAStoppedSearch) {
  SwarmSettings settings = roundNumbers();
  settings.max_iterations = 1;
  SwarmState state = atIdentity(settings);
  const auto swarm = templateOf({{0.5f, 0, 0, 0, 0, 0}});
  EXPECT_THROW(update(settings, state, swarm, std::vector<float>{0.5f}), std::invalid_argument);
  const std::vector<float> losses = {0.5f, 0.4f};
  EXPECT_THROW(update(settings, state, swarm, losses, std::vector<uint32_t>{1}), std::invalid_argument);
  EXPECT_EQ(state.iteration, 0);
  update(settings, state, swarm, losses);
  EXPECT_THROW(update(settings, state, swarm, losses), std::invalid_argument);
}

TEST(SwarmSettings, NamesTheFieldThatIsOutOfRange) {
  EXPECT_NO_THROW(requireValid(paperSwarmSettings()));
  EXPECT_NO_THROW(requireValid(releaseSwarmSettings()));
  const auto complaint = [](auto change) -> std::string {
    SwarmSettings settings;
    change(settings);
    try {
      requireValid(settings);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.tau = 0; }), HasSubstr("swarm.tau"));
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.tau = NAN; }), HasSubstr("swarm.tau"));
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.axis_momentum = 1; }), HasSubstr("swarm.axis_momentum"));
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.levels.clear(); }), HasSubstr("swarm.levels"));
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.levels[0].pixel_stride = 0; }), HasSubstr("pixel_stride"));
  EXPECT_THAT(complaint([](SwarmSettings& s) { s.max_iterations = 0; }), HasSubstr("swarm.max_iterations"));
}

}  // namespace test_swarm_update
}  // namespace rosefusion::testing
