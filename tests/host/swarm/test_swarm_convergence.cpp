// The complete search on an objective whose optimum is known: fast motion, no depth images and no GPU.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "host/swarm/swarm_update.h"

namespace rosefusion::testing {
namespace test_swarm_convergence {

// Mean psi^2 of a scene as a bounded quadratic: a point moves by the pose's shift plus its rotation at 1.5 m
// distance, and everything is truncated once that reaches 0.3 m (three times a truncation of 0.1 m).
float boundedQuadratic(const Pose& pose, const Pose& truth) {
  const double shift = (pose.translation() - truth.translation()).squaredNorm();
  const double swing = 1.5 * rotationAngle(pose.inverse() * truth);
  return static_cast<float>(std::min(1.0, (shift + swing * swing) / (0.3 * 0.3)));
}

SwarmState search(const SwarmSettings& settings, const TemplateSet& templates, SwarmState state,
                  const Pose& truth) {
  while (!state.stopped()) {
    const SwarmTemplate& swarm_template = templates.at(state.level, state.serial);
    std::vector<float> losses;
    for (size_t i = 0; i < swarm_template.particles.size(); ++i)
      losses.push_back(boundedQuadratic(
          moveBy(state.centre, scaledParticle(swarm_template, i, state.axis_lengths)), truth));
    update(settings, state, swarm_template, losses);
  }
  return state;
}

// 4 m/s and 2.1 rad/s at 30 frames a second, in a direction drawn by the seed.
Pose fastMotion(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(x, y, z).normalized();
  };
  Pose pose = Pose::Identity();
  pose.translate(0.13 * direction()).rotate(Eigen::AngleAxisd(0.07, direction()));
  return pose;
}

class SwarmConvergence : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    TemplateOptions options;
    options.count = 2;
    templates_ = new TemplateSet(generateTemplates(options));
  }
  static void TearDownTestSuite() {
    delete templates_;
    templates_ = nullptr;
  }
  static TemplateSet* templates_;
};

TemplateSet* SwarmConvergence::templates_ = nullptr;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

TEST_F(SwarmConvergence, FindsAFastMotionWithinTwentyIterations) {
  const SwarmSettings settings = paperSwarmSettings();
  std::vector<double> shifts_m, turns_rad;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Pose truth = fastMotion(seed);
    const SwarmState found =
        search(settings, *templates_, beginFrame(settings, Pose::Identity(), nullptr), truth);
    EXPECT_LE(found.iteration, 20);
    shifts_m.push_back((found.centre.translation() - truth.translation()).norm());
    turns_rad.push_back(rotationAngle(found.centre.inverse() * truth));
  }
  EXPECT_LT(median(shifts_m), 2e-3);
  EXPECT_LT(median(turns_rad), 2e-3);
  // The worst of them is still the same basin, not a local optimum elsewhere.
  EXPECT_LT(*std::max_element(shifts_m.begin(), shifts_m.end()), 20e-3);
}

// Without the rescaling the swarm keeps its first size; this is what shows the test above can fail.
TEST_F(SwarmConvergence, NeedsTheRescaling) {
  SwarmSettings settings = paperSwarmSettings();
  settings.axis_momentum = 0.9999;
  std::vector<double> shifts_m;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Pose truth = fastMotion(seed);
    const SwarmState found =
        search(settings, *templates_, beginFrame(settings, Pose::Identity(), nullptr), truth);
    shifts_m.push_back((found.centre.translation() - truth.translation()).norm());
  }
  EXPECT_GT(median(shifts_m), 10e-3);
}

TEST_F(SwarmConvergence, GivesTheSameBitsTwice) {
  const SwarmSettings settings = paperSwarmSettings();
  const SwarmState start = beginFrame(settings, Pose::Identity(), nullptr);
  const SwarmState once = search(settings, *templates_, start, fastMotion(7));
  const SwarmState again = search(settings, *templates_, start, fastMotion(7));
  EXPECT_EQ(once.centre.matrix(), again.centre.matrix());
  EXPECT_EQ(once.axis_lengths, again.axis_lengths);
  EXPECT_EQ(once.iteration, again.iteration);
}

}  // namespace test_swarm_convergence
}  // namespace rosefusion::testing
