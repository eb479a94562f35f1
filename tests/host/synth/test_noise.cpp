// The depth noise against the distribution that its formula gives.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <tuple>

#include "host/synth/noise.h"

namespace rosefusion::testing {
namespace test_noise {

struct Moments {
  double mean = 0, sigma = 0;
};

/// How far the mean of the whole disparities lies above the true one.
double biasOf(DisparityRounding rounding) {
  return rounding == DisparityRounding::Simkinect ? 0.5 : 0;
}

/// Of z' = 351.3 / d', by summing over all whole d': it is drawn when 351.3 / z + bias + N(0, 1/6) lies
/// within 0.5 of it.
Moments expectedAt(double z, DisparityRounding rounding) {
  const double disparity = 351.3 / z + biasOf(rounding);
  const auto below = [&](double x) { return 0.5 * std::erfc(-(x - disparity) * 6 / std::sqrt(2.0)); };
  double sum = 0, squares = 0;
  for (int d = 1; d < 4000; ++d) {
    const double probability = below(d + 0.5) - below(d - 0.5), value = 351.3 / d;
    sum += probability * value;
    squares += probability * value * value;
  }
  return {sum, std::sqrt(squares - sum * sum)};
}

Moments measured(const cv::Mat& noisy) {
  cv::Scalar mean, sigma;
  cv::meanStdDev(noisy, mean, sigma);
  return {mean[0], sigma[0]};
}

class HandaNoise : public ::testing::TestWithParam<std::tuple<double, DisparityRounding>> {};

TEST_P(HandaNoise, OnAPlaneHasTheFormulasMeanAndSigma) {
  const auto [z, rounding] = GetParam();
  // Where z lies close to one whole disparity, few pixels read another (0.4 % at 1.001 m): it takes many for
  // a sigma that is good to 2 %.
  const cv::Mat plane(1200, 1600, CV_32FC1, cv::Scalar(z));
  Rng rng(7);
  const Moments seen = measured(addHandaNoise(plane, rng, rounding)), expected = expectedAt(z, rounding);
  EXPECT_NEAR(seen.mean, expected.mean, 5 * expected.sigma / std::sqrt(1200.0 * 1600) + 1e-6);
  EXPECT_NEAR(seen.sigma, expected.sigma, 0.02 * expected.sigma + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Depths, HandaNoise,
                         ::testing::Combine(::testing::Values(1.0, 1.001, 2.0, 2.01, 4.0, 4.03),
                                            ::testing::Values(DisparityRounding::Published,
                                                              DisparityRounding::Simkinect)));

TEST(HandaNoise, IsAsPublishedUnlessAskedFor) {
  const cv::Mat plane(40, 40, CV_32FC1, cv::Scalar(3));
  Rng one(1), other(1);
  EXPECT_EQ(cv::norm(addHandaNoise(plane, one), addHandaNoise(plane, other, DisparityRounding::Published),
                     cv::NORM_INF),
            0);
}

// Over many depths the effect of where z lies between two disparities averages out; what stays is
// documented: nothing, or half a step of disparity as in the program simkinect.
TEST(HandaNoise, BiasAndSigmaAreTheDocumentedOnes) {
  for (const DisparityRounding rounding : {DisparityRounding::Published, DisparityRounding::Simkinect})
    for (const double z : {1.0, 2.0, 4.0}) {
      double bias = 0, squares = 0;
      const int steps = 400;
      for (int i = 0; i < steps; ++i) {
        const double true_z = 351.3 / (351.3 / z + i / double(steps));  // one whole step of disparity
        const cv::Mat plane(40, 40, CV_32FC1, cv::Scalar(true_z));
        Rng rng(i);
        const cv::Mat error = addHandaNoise(plane, rng, rounding) - plane;
        bias += cv::mean(error)[0] / steps;
        squares += cv::mean(error.mul(error))[0] / steps;
      }
      const double step = z * z / 351.3;  // of one disparity, in metres
      EXPECT_NEAR(bias, -biasOf(rounding) * step, 0.03 * step / 2) << z;
      EXPECT_NEAR(std::sqrt(squares - bias * bias), step / 3, 0.03 * step / 3) << z;
    }
}

TEST(HandaNoise, JitterOnASlopeIsHalfAPixel) {
  cv::Mat slope(480, 400, CV_32FC1);
  const double per_pixel = 0.002;
  for (int v = 0; v < slope.rows; ++v)
    for (int u = 0; u < slope.cols; ++u) slope.at<float>(v, u) = static_cast<float>(0.3 + per_pixel * u);
  Rng rng(3);
  const cv::Mat error = addHandaNoise(slope, rng) - slope;
  // Near the left edge depth noise is small (0.1 mm at 0.35 m) against the jitter's 1 mm.
  const Moments m = measured(error(cv::Rect(8, 0, 40, 480)));
  const double depth_sigma = 0.35 * 0.35 / 351.3 / 3;
  EXPECT_NEAR(m.sigma, std::hypot(0.5 * per_pixel, depth_sigma), 0.03 * per_pixel);
}

TEST(HandaNoise, InvalidPixelsStayInvalidAndDoNotSpread) {
  cv::Mat plane(60, 80, CV_32FC1, cv::Scalar(2));
  plane(cv::Rect(0, 0, 40, 60)).setTo(0);
  Rng rng(5);
  const cv::Mat noisy = addHandaNoise(plane, rng);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u) {
      const float z = noisy.at<float>(v, u);
      EXPECT_TRUE(z == 0 || (z > 1.9 && z < 2.1));
      if (u < 36) {
        EXPECT_EQ(z, 0);
      }
      if (u > 44) {
        EXPECT_GT(z, 1.9);
      }
    }
}

TEST(ColourNoise, IsNormalAndLeavesTheMean) {
  cv::Mat grey(240, 320, CV_8UC3, cv::Scalar(120, 60, 200));
  Rng rng(9);
  addColourNoise(grey, rng);
  cv::Scalar mean, sigma;
  cv::meanStdDev(grey, mean, sigma);
  const double expected[] = {120, 60, 200};
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(mean[channel], expected[channel], 5 * kColourSigma / std::sqrt(240.0 * 320));
    // Rounding to whole numbers adds a twelfth to the variance.
    EXPECT_NEAR(sigma[channel], std::hypot(kColourSigma, std::sqrt(1.0 / 12)), 0.02 * kColourSigma);
  }
}

}  // namespace test_noise
}  // namespace rosefusion::testing
