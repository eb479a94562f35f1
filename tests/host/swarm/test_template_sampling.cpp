// Swarm templates: exact sizes, blue noise, no bias, the same bits everywhere.
#include "host/swarm/template_sampling.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "host/core/error.h"
#include "host/swarm/poisson_ball.h"
#include "host/swarm/template_plot.h"
#include "host/swarm/template_statistics.h"

namespace rosefusion::testing {
namespace test_template_sampling {

using ::testing::HasSubstr;

constexpr double kFloatRounding = 1e-6;  // particles are stored as floats of order one

TemplateOptions small() {
  TemplateOptions options;
  options.sizes = {256, 64};
  options.count = 2;
  return options;
}

TemplateStatistics measure(const std::vector<Point6>& points) {
  SwarmTemplate swarm_template;
  for (const Point6& point : points) {
    Particle& particle = swarm_template.particles.emplace_back();
    std::transform(point.begin(), point.end(), particle.begin(),
                   [](double x) { return static_cast<float>(x); });
  }
  return measureTemplates({swarm_template});
}

// Largest deviation from the uniform ball's mean and covariance, in standard errors of independent samples: E
// x = 0, E x^2 = 1/8, E x^4 = 3/80, E x^2 y^2 = 1/80 in the unit ball of R^6. Above 4 of 27 numbers is a
// bias.
double biasInStandardErrors(const TemplateStatistics& s) {
  const double n = static_cast<double>(s.particles * s.templates);
  double worst = 0;
  for (int i = 0; i < 6; ++i) {
    worst = std::max(worst, std::abs(s.mean[i]) / std::sqrt(1.0 / 8 / n));
    worst = std::max(worst, std::abs(s.covariance(i, i) - 1.0 / 8) / std::sqrt((3.0 / 80 - 1.0 / 64) / n));
    for (int j = 0; j < i; ++j)
      worst = std::max(worst, std::abs(s.covariance(i, j)) / std::sqrt(1.0 / 80 / n));
  }
  return worst;
}

class TemplateOfSize : public ::testing::TestWithParam<int> {};

TEST_P(TemplateOfSize, IsAnUnbiasedPoissonDiskSample) {
  TemplateOptions options;
  options.sizes = {GetParam()};
  options.count = 2;
  const TemplateSet set = generateTemplates(options);
  for (const SwarmTemplate& swarm_template : set.levels[0]) {
    const TemplateStatistics s = measureTemplates({swarm_template});
    EXPECT_EQ(s.particles, static_cast<size_t>(GetParam()));
    EXPECT_TRUE(s.zero_particle);
    EXPECT_LE(s.largest_norm, 1 + kFloatRounding);
    EXPECT_GE(s.minimum_distance, swarm_template.radius - kFloatRounding);
    EXPECT_LT(biasInStandardErrors(s), 4);
    // The closest of n independent points are about (2 / n^2)^(1/6) apart: 0.2 to 0.4 in this unit.
    EXPECT_GT(swarm_template.radius * std::pow(GetParam(), 1.0 / 6), 1.1);
    for (const double density : s.shell_density)
      EXPECT_NEAR(density, 1, 4 / std::sqrt(static_cast<double>(GetParam()) / kVolumeShells));
  }
  EXPECT_NE(set.levels[0][0].particles, set.levels[0][1].particles);
}

INSTANTIATE_TEST_SUITE_P(TemplateSampling, TemplateOfSize, ::testing::Values(10240, 3072, 1024));

// What the thinning is for, and proof that the checks above notice a biased sample.
TEST(PoissonBall, CrowdsAtTheSurfaceUntilThinned) {
  PortableRandom random(3);
  const TemplateStatistics s = measure(poissonBall(0.3, 30, random));
  EXPECT_GT(s.shell_density.back(), 1.4);
  EXPECT_GT(biasInStandardErrors(s), 4);
  EXPECT_GE(s.minimum_distance, 0.3 - kFloatRounding);
}

TEST(PoissonBall, StartsAtTheOriginAndLeavesNoRoom) {
  PortableRandom random(5);
  const std::vector<Point6> points = poissonBall(0.6, 2000, random);
  EXPECT_EQ(points[0], Point6{});
  // Random points of the ball find no free place except for rare gaps.
  int free = 0;
  constexpr int kDarts = 2000;
  for (int i = 0; i < kDarts; ++i) {
    Point6 dart = random.direction();
    const double radius = random.ballRadius();
    for (double& x : dart) x *= radius;
    bool hit = false;
    for (const Point6& point : points) {
      double squared = 0;
      for (size_t d = 0; d < 6; ++d) squared += (point[d] - dart[d]) * (point[d] - dart[d]);
      hit |= squared < 0.6 * 0.6;
    }
    free += !hit;
  }
  EXPECT_LT(free, kDarts / 100);
}

TEST(PortableRandom, DirectionsAreUniformOnTheSphere) {
  PortableRandom random(11);
  constexpr int kSamples = 20000;
  std::vector<Point6> points;
  for (int i = 0; i < kSamples; ++i) {
    points.push_back(random.direction());
    double squared = 0;
    for (double x : points.back()) squared += x * x;
    ASSERT_NEAR(squared, 1, 1e-12);
    const double radius = random.ballRadius();
    for (double& x : points.back()) x *= radius;
  }
  EXPECT_LT(biasInStandardErrors(measure(points)), 4);
}

// Any platform and compiler must give these bits.
TEST(TemplateSampling, GivesTheSameBitsOnEveryPlatform) {
  TemplateOptions options;
  options.sizes = {64};
  options.count = 1;
  const TemplateSet set = generateTemplates(options);
  uint64_t hash = 0xcbf29ce484222325u;
  for (const Particle& particle : set.levels[0][0].particles)
    for (const float x : particle) {
      uint32_t bits;
      std::memcpy(&bits, &x, sizeof(bits));
      hash = (hash ^ bits) * 0x100000001b3u;
    }
  EXPECT_EQ(hash, 17799771132147853478u)
      << "raise kVersion in template_file.cpp when the sampling is changed on purpose";
}

TEST(TemplateSampling, DependsOnTheSeedAndOnNothingElse) {
  const TemplateSet set = generateTemplates(small());
  TemplateOptions other = small();
  other.count = 1;
  EXPECT_EQ(generateTemplates(other).levels[1][0].particles, set.levels[1][0].particles);
  other.sizes = {64};
  EXPECT_EQ(generateTemplates(other).levels[0][0].particles, set.levels[1][0].particles);
  other.seed = 2;
  EXPECT_NE(generateTemplates(other).levels[0][0].particles, set.levels[1][0].particles);
}

// The release averages only the first 200 advantage particles, so that a prefix must be as good as the whole.
TEST(TemplateSampling, APrefixIsUnbiasedToo) {
  TemplateOptions options;
  options.sizes = {1024};
  options.count = 1;
  SwarmTemplate prefix = generateTemplates(options).levels[0][0];
  prefix.particles.resize(128);
  EXPECT_LT(biasInStandardErrors(measureTemplates({prefix})), 4);
  PortableRandom random(1);
  std::vector<Point6> found = poissonBall(0.37, 30, random);
  found.resize(128);
  EXPECT_GT(biasInStandardErrors(measure(found)), 4);  // in the order of finding they surround the origin
}

TEST(TemplateSampling, ReportsProgressOncePerTemplate) {
  std::vector<int> seen;
  generateTemplates(small(), [&](int done, int total) {
    EXPECT_EQ(total, 4);
    seen.push_back(done);
  });
  EXPECT_THAT(seen, ::testing::ElementsAre(1, 2, 3, 4));
}

TEST(TemplateSampling, PassesOnWhatTheProgressCallbackThrows) {
  EXPECT_THROW(generateTemplates(small(), [](int, int) { throw std::runtime_error("stop"); }),
               std::runtime_error);
}

TEST(TemplateSampling, NamesTheOptionThatIsOutOfRange) {
  const auto complaint = [](auto change) -> std::string {
    TemplateOptions options = small();
    change(options);
    try {
      generateTemplates(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(complaint([](TemplateOptions& o) { o.sizes = {10}; }), HasSubstr("size of 10"));
  EXPECT_THAT(complaint([](TemplateOptions& o) { o.sizes = {}; }), HasSubstr("no size"));
  EXPECT_THAT(complaint([](TemplateOptions& o) { o.count = 0; }), HasSubstr("count"));
  EXPECT_THAT(complaint([](TemplateOptions& o) { o.candidates = 0; }), HasSubstr("candidates"));
}

TEST(TemplateSet, TakesTemplatesInTurn) {
  const TemplateSet set = generateTemplates(small());
  EXPECT_EQ(&set.at(1, 0), &set.levels[1][0]);
  EXPECT_EQ(&set.at(1, 3), &set.levels[1][1]);
}

// Every panel shows the red ring of the zero move at its centre and blue particles around it.
TEST(TemplatePlot, DrawsAllFifteenProjections) {
  const TemplateSet set = generateTemplates(small());
  const cv::Mat plot = plotTemplate(set.levels[0][0], "title");
  ASSERT_EQ(plot.type(), CV_8UC3);
  cv::Mat red, blue;
  cv::inRange(plot, cv::Scalar(0, 0, 180), cv::Scalar(80, 80, 255), red);
  cv::inRange(plot, cv::Scalar(120, 40, 0), cv::Scalar(180, 100, 50), blue);
  const int panel_width = plot.cols / 5, panel_height = (plot.rows - 84) / 3;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 5; ++column) {
      const cv::Rect panel(column * panel_width, 84 + row * panel_height, panel_width, panel_height);
      EXPECT_GT(cv::countNonZero(red(panel)), 20) << row << ' ' << column;
      EXPECT_GT(cv::countNonZero(blue(panel)), 10) << row << ' ' << column;
    }
}

}  // namespace test_template_sampling
}  // namespace rosefusion::testing
