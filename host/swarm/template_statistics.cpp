#include "host/swarm/template_statistics.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace rosefusion {
namespace {

struct ParticleCloud {
  const std::vector<Particle>& particles;

  size_t kdtree_get_point_count() const { return particles.size(); }
  float kdtree_get_pt(size_t index, size_t dimension) const { return particles[index][dimension]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, ParticleCloud, double>,
                                                   ParticleCloud, 6, size_t>;

// Distance from each particle to its nearest other one; none where there is no other.
std::vector<double> nearestDistances(const std::vector<Particle>& particles) {
  const ParticleCloud cloud{particles};
  const KdTree tree(6, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(32));
  std::vector<double> distances;
  distances.reserve(particles.size());
  for (const Particle& particle : particles) {
    std::array<size_t, 2> found{};
    std::array<double, 2> squared{};
    // The first is the particle itself.
    if (tree.knnSearch(particle.data(), 2, found.data(), squared.data()) == 2)
      distances.push_back(std::sqrt(squared[1]));
  }
  return distances;
}

}  // namespace

TemplateStatistics measureTemplates(const std::vector<SwarmTemplate>& templates) {
  TemplateStatistics result;
  result.templates = templates.size();
  result.particles = templates.front().particles.size();
  result.radius = templates.front().radius;
  result.minimum_distance = 2;
  const double total = static_cast<double>(result.templates * result.particles);
  Eigen::Matrix<double, 6, 6> second_moment = Eigen::Matrix<double, 6, 6>::Zero();
  for (const SwarmTemplate& swarm_template : templates) {
    result.radius = std::min(result.radius, swarm_template.radius);
    result.zero_particle &= swarm_template.particles[0] == Particle{};
    for (const double distance : nearestDistances(swarm_template.particles)) {
      result.minimum_distance = std::min(result.minimum_distance, distance);
      result.mean_nearest_distance += distance / total;
    }
    for (const Particle& particle : swarm_template.particles) {
      const Eigen::Matrix<double, 6, 1> x =
          Eigen::Map<const Eigen::Matrix<float, 6, 1>>(particle.data()).cast<double>();
      result.mean += x / total;
      second_moment += x * x.transpose() / total;
      result.largest_norm = std::max(result.largest_norm, x.norm());
      const double enclosed_volume = std::pow(x.squaredNorm(), 3);
      const auto shell =
          std::min(static_cast<size_t>(enclosed_volume * kVolumeShells), size_t{kVolumeShells - 1});
      result.shell_density[shell] += kVolumeShells / total;
    }
  }
  result.covariance = second_moment - result.mean * result.mean.transpose();
  return result;
}

}  // namespace rosefusion
