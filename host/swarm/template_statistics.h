// How well a swarm template covers the unit ball.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "host/swarm/template_sampling.h"

namespace rosefusion {

inline constexpr int kVolumeShells = 10;

/// Of one template, or of several of one size: extremes over all of them, means over their particles
/// together.
struct TemplateStatistics {
  size_t templates = 0;
  size_t particles = 0;  ///< per template
  double radius = 0;     ///< smallest Poisson-disk radius asked for
  double minimum_distance =
      0;  ///< smallest distance of two particles of one template; never below the radius
  double mean_nearest_distance = 0;  ///< from a particle to its nearest neighbour
  double largest_norm = 0;
  bool zero_particle = true;  ///< particle 0 is exactly the zero move in each
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Particles in shells of equal volume, inside out, over what a uniform density gives (1 = unbiased).
  std::vector<double> shell_density = std::vector<double>(kVolumeShells, 0.0);
};

/// Covariance of the uniform distribution in the unit ball of R^6: 1 / (6 + 2) on each axis.
inline constexpr double kUniformBallVariance = 1.0 / 8;

/// `templates` must not be empty and all of one size.
TemplateStatistics measureTemplates(const std::vector<SwarmTemplate>& templates);

}  // namespace rosefusion
