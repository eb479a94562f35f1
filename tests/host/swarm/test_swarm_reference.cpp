// A five-iteration search against numbers computed from the paper's equations by an independent script, and
// proof that every constant matters to it.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>

#include "host/swarm/swarm_update.h"

namespace rosefusion::testing {
namespace test_swarm_reference {

SwarmTemplate fiveParticles() {
  return {{{0, 0, 0, 0, 0, 0},
           {0.5f, 0, 0, 0.2f, 0, 0},
           {0, 0.8f, 0, 0, 0, 0.4f},
           {-0.3f, 0, 0.6f, 0, -0.5f, 0},
           {0, 0, -0.9f, 0, 0, 0}},
          0.1};
}

struct Input {
  std::vector<float> losses;
  std::vector<uint32_t> pixel_counts;
};

const std::vector<Input> kInputs = {{{0.5f, 0.2f, 0.3f, 0.6f, NAN}, {100, 80, 60, 90, 0}},
                                    {{0.25f, 0.26f, 0.3f, 0.4f, -1}, {100, 100, 100, 100, 100}},
                                    {{0.24f, 0.5f, 0.2f, 0.1f, 0.3f}, {100, 100, 100, 100, 100}},
                                    {{0.1f, 0.2f, 0.2f, 0.2f, 0.2f}, {100, 100, 100, 100, 100}},
                                    {{0.11f, 0.2f, 0.2f, 0.2f, 0.2f}, {100, 100, 100, 100, 100}}};

// One iteration's result: advantage count, v, rho before and after, r, and the pose (t, then qw qx qy qz).
struct Expected {
  int advantage;
  std::array<double, 6> move;
  double before, after;
  std::array<double, 6> lengths;
  std::array<double, 3> translation;
  std::array<double, 4> quaternion;
  size_t next_level;
  std::array<int, 2> next_offset;  // of the pixel grid; strides 4 and 8, shift 5
};

// Start: translation (1, 2, 3), a quarter turn about z, r0 = 0.5 on every axis. Fitness exp(-loss); particle
// 4 is not counted in the first two iterations; the second, fourth and fifth have an empty advantage set.
const std::vector<Expected> kExpected = {
    {2,
     {0.153107978865674, 0.155027236125007, 0, 0.061611583002609, 0, 0.0779798786011724},
     0.606530659712633,
     0.788534337218665,
     {0.172575908621638, 0.174101154873585, 0.0509, 0.0998631265398451, 0.0509, 0.11287111772553},
     {1.15310797886567, 2.15502723612501, 3},
     {0.648466021592722, 0.0435659681407826, -0.0435659681407826, 0.758746223502707},
     1,
     {5, 5}},
    {0,
     {0, 0, 0, 0, 0, 0},
     0.778800783071405,
     0.778800783071405,
     {0.179805154755643, 0.179957679380838, 0.167637563893479, 0.172533876547464, 0.167637563893479,
      0.173834675666033},
     {1.15310797886567, 2.15502723612501, 3},
     {0.648466021592722, 0.0435659681407826, -0.0435659681407826, 0.758746223502707},
     0,
     {2, 2}},
    {2,
     {-0.04242101582618, 0.0307474801696665, 0.0791006883050928, 0, -0.0659829995215109, 0.0148654690443512},
     0.786627865286354,
     0.886447238949082,
     {0.0560876001165745, 0.0458641013193068, 0.0870422459801941, 0.0181533876547464, 0.0755368412330511,
      0.0313218343805386},
     {1.11068696303949, 2.18577471629467, 3.07910068830509},
     {0.632827308338767, -0.00595052069563347, -0.0856063070975946, 0.769523066132052},
     1,
     {7, 7}},
    {0,
     {0, 0, 0, 0, 0, 0},
     0.904837416687647,
     0.904837416687647,
     {0.0755386915277651, 0.0745163416480384, 0.0786341561141271, 0.0717452702815823, 0.0774836156394128,
      0.0730621149541616},
     {1.11068696303949, 2.18577471629467, 3.07910068830509},
     {0.632827308338767, -0.00595052069563347, -0.0856063070975946, 0.769523066132052},
     0,
     {0, 1}},
    {0,
     {0, 0, 0, 0, 0, 0},
     0.895834135830487,
     0.895834135830487,
     {0.0840998339021869, 0.0839975989142142, 0.0844093803608231, 0.0837204917775686, 0.0842943263133517,
      0.0838521762448265},
     {1.11068696303949, 2.18577471629467, 3.07910068830509},
     {0.632827308338767, -0.00595052069563347, -0.0856063070975946, 0.769523066132052},
     0,
     {1, 2}},
};

SwarmSettings paperOnFiveParticles() {
  SwarmSettings settings = paperSwarmSettings();
  settings.levels = {{5, 4}, {5, 8}};
  return settings;
}

template <size_t N>
double difference(const Eigen::Matrix<double, static_cast<int>(N), 1>& actual,
                  const std::array<double, N>& expected) {
  return (actual - Eigen::Map<const Eigen::Matrix<double, static_cast<int>(N), 1>>(expected.data()))
      .cwiseAbs()
      .maxCoeff();
}

// Largest difference of any number of the search from the expected ones; infinite when a discrete one
// differs.
double deviation(const SwarmSettings& settings) {
  Pose start = Pose::Identity();
  start.translate(Eigen::Vector3d(1, 2, 3)).rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  SwarmState state = beginFrame(settings, start, nullptr);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  double worst = 0;
  for (size_t i = 0; i < kInputs.size(); ++i) {
    if (state.stopped()) return kInfinite;
    const SwarmStep step =
        update(settings, state, fiveParticles(), kInputs[i].losses, kInputs[i].pixel_counts);
    const Expected& expected = kExpected[i];
    const Eigen::Vector2i offset = pixelOffset(settings, state);
    if (step.advantage != expected.advantage || state.level != expected.next_level ||
        offset != Eigen::Vector2i(expected.next_offset[0], expected.next_offset[1]))
      return kInfinite;
    const Eigen::Quaterniond q = canonical(Eigen::Quaterniond(state.centre.linear()));
    worst = std::max({worst, difference<6>(step.move, expected.move),
                      difference<6>(step.axis_lengths, expected.lengths),
                      difference<3>(state.centre.translation(), expected.translation),
                      difference<4>(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()), expected.quaternion),
                      std::abs(step.likelihood_before - expected.before),
                      std::abs(step.likelihood_after - expected.after)});
  }
  return state.stop_reason == StopReason::EmptySets ? worst : kInfinite;
}

// The expected numbers have 15 digits and are of order one.
constexpr double kRounding = 1e-13;

TEST(SwarmReference, FollowsThePapersEquations) {
  EXPECT_LT(deviation(paperOnFiveParticles()), kRounding);
}

struct Perturbation {
  std::string name;
  std::function<void(SwarmSettings&)> apply;

  friend void PrintTo(const Perturbation& perturbation, std::ostream* out) { *out << perturbation.name; }
};

class EverySetting : public ::testing::TestWithParam<Perturbation> {};

TEST_P(EverySetting, ChangesTheResultWhenPerturbed) {
  SwarmSettings settings = paperOnFiveParticles();
  GetParam().apply(settings);
  EXPECT_GT(deviation(settings), 1e4 * kRounding);
}

INSTANTIATE_TEST_SUITE_P(
    SwarmReference, EverySetting,
    ::testing::Values(
        Perturbation{"loss", [](SwarmSettings& s) { s.loss = FitnessLoss::Absolute; }},
        Perturbation{"tau", [](SwarmSettings& s) { s.tau *= 1.001; }},
        Perturbation{"minimum_counted_share", [](SwarmSettings& s) { s.minimum_counted_share = 0.6; }},
        Perturbation{"max_advantage_particles", [](SwarmSettings& s) { s.max_advantage_particles = 1; }},
        Perturbation{"axis_scale", [](SwarmSettings& s) { s.axis_scale *= 1.001; }},
        Perturbation{"axis_epsilon", [](SwarmSettings& s) { s.axis_epsilon *= 1.001; }},
        Perturbation{"axis_momentum", [](SwarmSettings& s) { s.axis_momentum *= 1.001; }},
        Perturbation{"empty_set_scale", [](SwarmSettings& s) { s.empty_set_scale *= 1.001; }},
        Perturbation{"initial_likelihood", [](SwarmSettings& s) { s.initial_likelihood *= 1.001; }},
        Perturbation{"first_axis_scale", [](SwarmSettings& s) { s.first_axis_scale *= 1.001; }},
        Perturbation{"levels", [](SwarmSettings& s) { s.levels.pop_back(); }},
        Perturbation{"restart_levels_when_empty",
                     [](SwarmSettings& s) { s.restart_levels_when_empty = false; }},
        Perturbation{"pixel_shift", [](SwarmSettings& s) { s.pixel_shift = 6; }},
        Perturbation{"max_iterations", [](SwarmSettings& s) { s.max_iterations = 4; }},
        Perturbation{"max_empty_sets", [](SwarmSettings& s) { s.max_empty_sets = 1; }},
        Perturbation{"minimum_move", [](SwarmSettings& s) { s.minimum_move = 0.2; }}),
    [](const auto& instance) { return instance.param.name; });

}  // namespace test_swarm_reference
}  // namespace rosefusion::testing
