// The native loop against the formula of the loss, written out voxel by voxel in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/bench/native_fitness.h"

namespace rosefusion::testing {
namespace test_native_fitness {

constexpr float kVoxel = 0.05f;

/// Two blocks apart from each other, with codes that the 16-bit storage holds exactly.
VolumeContents tinyVolume() {
  VolumeContents contents;
  contents.blocks = {{0, 0, 0, 0}, {-1, 0, 1, 0}, {1, 0, 1, 0}};
  contents.tsdf.assign(3 * shader::kBlockVoxels, 1.0f);
  std::mt19937 random(7);
  for (std::size_t i = shader::kBlockVoxels; i < contents.tsdf.size(); ++i)
    contents.tsdf[i] = static_cast<float>(static_cast<int>(random() % 65535) - 32767) / 32767.0f;
  return contents;
}

double psiAt(const VolumeContents& contents, const glm::dvec3& world) {
  const glm::ivec3 voxel(static_cast<int>(std::floor(world.x / kVoxel)),
                         static_cast<int>(std::floor(world.y / kVoxel)),
                         static_cast<int>(std::floor(world.z / kVoxel)));
  for (std::size_t slot = 1; slot < contents.blocks.size(); ++slot) {
    const glm::ivec3 l = voxel - glm::ivec3(contents.blocks[slot]) * 8;
    if (l.x >= 0 && l.x < 8 && l.y >= 0 && l.y < 8 && l.z >= 0 && l.z < 8)
      return contents.tsdf[slot * shader::kBlockVoxels + (l.z * 8 + l.y) * 8 + l.x];
  }
  return 1;
}

struct Case {
  VolumeContents contents = tinyVolume();
  std::vector<glm::vec4> templates, points;
  SwarmPlacement swarm;

  explicit Case(std::uint32_t particles) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto entry = [&] { return glm::vec4(unit(random), unit(random), unit(random), 0); };
    for (std::uint32_t i = 0; i < particles + 3; ++i) {
      templates.push_back(entry());
      templates.push_back(entry());
    }
    for (int i = 0; i < 200; ++i)
      points.emplace_back(0.5f * unit(random), 0.15f * unit(random), 0.5f + 0.4f * unit(random), 1);
    const float c = std::cos(0.3f), s = std::sin(0.3f);
    swarm.world_from_camera = glm::mat4(c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0.02f, 0.15f, 0.05f, 1);
    swarm.translation_lengths = {0.1f, 0.05f, 0.2f, 0};
    swarm.rotation_lengths = {0.2f, 0.1f, 0.3f, 0};
    swarm.first_particle = 3;
    swarm.particles = particles;
  }

  double expected(std::uint32_t particle, bool squared) const {
    const std::size_t e = 2 * (swarm.first_particle + particle);
    const glm::dvec3 q = glm::dvec3(templates[e + 1]) * glm::dvec3(swarm.rotation_lengths);
    const double w = std::sqrt(1 - (q.x * q.x + q.y * q.y + q.z * q.z));
    double sum = 0;
    for (const glm::vec4& p : points) {
      const glm::dvec3 in_world(glm::dmat4(swarm.world_from_camera) * glm::dvec4(glm::dvec3(p), 0));
      const auto cross = [](glm::dvec3 a, glm::dvec3 b) {
        return glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
      };
      const glm::dvec3 turned = in_world + 2.0 * cross(q, cross(q, in_world) + w * in_world);
      const double psi =
          psiAt(contents, turned + glm::dvec3(swarm.world_from_camera[3]) +
                              glm::dvec3(templates[e]) * glm::dvec3(swarm.translation_lengths));
      sum += squared ? psi * psi : std::abs(psi);
    }
    return sum / static_cast<double>(points.size());
  }
};

class NativeFitness : public ::testing::TestWithParam<int> {};

TEST_P(NativeFitness, GivesTheFormulasMeanLoss) {
  const int threads = GetParam();
  const Case c(37);  // no whole number of lane groups
  const NativeVolume volume(c.contents, kVoxel);
  for (const Loss loss : {Loss::Squared, Loss::Absolute}) {
    const std::vector<float> losses = nativeLosses(volume, c.templates, c.points, c.swarm, loss, threads);
    ASSERT_EQ(losses.size(), 37u);
    double least = 1;
    for (std::uint32_t i = 0; i < 37; ++i) {
      // Single precision may put a point next to a voxel's face into the neighbour: none of these 7400 does.
      EXPECT_NEAR(losses[i], c.expected(i, loss == Loss::Squared), 1e-6) << "particle " << i;
      least = std::min<double>(least, losses[i]);
    }
    EXPECT_LT(least, 0.9);  // the points do meet the blocks
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, NativeFitness, ::testing::Values(1, 3));

TEST(NativeFitnessEdges, NoPointsMeansNoLoss) {
  const Case c(5);
  const auto losses =
      nativeLosses(NativeVolume(c.contents, kVoxel), c.templates, {}, c.swarm, Loss::Squared, 2);
  EXPECT_EQ(losses, std::vector<float>(5, -1.0f));
}

TEST(NativeFitnessEdges, PointsFarOutsideTheTableAreUnobserved) {
  Case c(5);
  c.points = {{1e6f, 0, 0, 1}, {-1e6f, 3e5f, -1e6f, 1}};
  for (const float loss :
       nativeLosses(NativeVolume(c.contents, kVoxel), c.templates, c.points, c.swarm, Loss::Squared, 1))
    EXPECT_EQ(loss, 1.0f);
}

}  // namespace test_native_fitness
}  // namespace rosefusion::testing
