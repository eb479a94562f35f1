#include "tests/reference/integrate.h"

#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {

// Each update stores the mean in 16 bits of [-1, 1] (half a step is 1.5e-5).
constexpr double kStoringError = 0.5 / 32767 + 1e-6;  // and a single-precision mean
// Weights are stored in 1/256; that is also the least that a depth weighs.
constexpr double kWeightUnit = 1.0 / 256;
// Each 8-bit colour is a mean rounded to half a level.
constexpr double kColourStoringError = 0.5 + 1e-3;
constexpr int kColourWeightCap = 64;

// The error e of a mean that is rounded by q at each of n updates: e_n = e_(n-1) (n-1)/n + q, so q (n+1)/2.
// From the weight cap W on it is e_n = e_(n-1) W/(W+1) + q, which never exceeds q (W+1).
double accumulated(double q, double updates, double cap) {
  return updates <= cap ? q * (updates + 1) / 2 : std::min(q * (updates + 1), q * (cap + 1));
}

std::string where(const Block& block, int voxel) {
  return "block (" + std::to_string(block[0]) + ", " + std::to_string(block[1]) + ", " +
         std::to_string(block[2]) + ") voxel " + std::to_string(voxel);
}

}  // namespace

void TsdfMap::integrate(std::span<const Block> blocks, const PointImage& image,
                        std::span<const std::uint32_t> rgb, const Intrinsics& camera,
                        const Pose& world_from_camera) {
  for (const Block& block : blocks) blocks_.try_emplace(block, 512);
  const Pose camera_from_world = world_from_camera.inverse();
  for (auto& [block, voxels] : blocks_)
    for (int i = 0; i < 512; ++i) {
      const Eigen::Vector3d in_block(i % 8 + 0.5, i / 8 % 8 + 0.5, i / 64 + 0.5);
      const Eigen::Vector3d corner(8.0 * block[0], 8.0 * block[1], 8.0 * block[2]);
      update(voxels[i], camera_from_world * ((corner + in_block) * options_.voxel_size), image, rgb, camera);
    }
}

void TsdfMap::update(Voxel& voxel, const Eigen::Vector3d& in_camera, const PointImage& image,
                     std::span<const std::uint32_t> rgb, const Intrinsics& camera) const {
  if (in_camera.z() < kPositionError) {
    voxel.uncertain |= in_camera.z() > -kPositionError;
    return;
  }
  const Eigen::Vector2d uv = camera.project(in_camera);
  // What the position's error moves the projection by, and the rounding of pixel coordinates in the hundreds.
  const double pixel_error =
      3 * std::abs(camera.fx) * kPositionError * in_camera.norm() / (in_camera.z() * in_camera.z()) + 1e-4;
  const int u = int(std::floor(uv.x() + 0.5)), v = int(std::floor(uv.y() + 0.5));
  const bool near_border =
      std::abs(uv.x() - u) > 0.5 - pixel_error || std::abs(uv.y() - v) > 0.5 - pixel_error;
  const bool near_image = u >= -1 && v >= -1 && u <= camera.width && v <= camera.height;
  if (near_border && near_image) voxel.uncertain = voxel.colour_uncertain = true;
  if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) return;
  const std::size_t pixel = std::size_t(v) * camera.width + u;
  const double z = image.depth[pixel];
  if (z <= 0) return;

  // The voxel's own ray meets the measured depth here.
  const Eigen::Vector3d surface = in_camera * (z / in_camera.z());
  const double distance = surface.norm() - in_camera.norm();
  const double distance_error = 4 * kPositionError * (1 + surface.norm() / in_camera.z());
  voxel.uncertain |= std::abs(distance + options_.truncation) < distance_error;
  voxel.colour_uncertain |= std::abs(std::abs(distance) - options_.truncation) < distance_error;
  if (distance < -options_.truncation) return;

  const double value = std::min(1.0, distance / options_.truncation);
  if (options_.thin_walls && voxel.weight > 0) {
    // Half a voxel, or what noise makes likely; in truncations.
    const double least =
        std::max(options_.thin_walls_deviations * options_.noise.deviation(z), 0.5 * options_.voxel_size) /
        options_.truncation;
    const double error = voxel.tsdf_error + distance_error / options_.truncation + 1e-6;
    const auto below = [&](double a, double b) {
      voxel.uncertain |= std::abs(a - b) < error;
      return a < b;
    };
    // A solid lies behind every surface seen of it, so its distance is the largest of all views'.
    if (below(value, -least) && below(value, voxel.tsdf - least) && below(voxel.tsdf, least)) {
      voxel.kept = true;
      return;
    }
    if (below(voxel.tsdf, -least) && below(voxel.tsdf, value - least)) {
      voxel.replaced = true;
      voxel.tsdf_error = voxel.weight = voxel.weight_error = 0;
      voxel.updates = 0;
      if (distance < options_.truncation) voxel.colour_updates = 0;
    }
  }
  const double gain = std::max(options_.noise.weight(z), kWeightUnit), total = voxel.weight + gain;
  // Errors of the old mean count by its share; those of its weight move the mean towards or from the value.
  const double weight_error = voxel.weight_error;
  voxel.tsdf_error = voxel.tsdf_error * (voxel.weight + weight_error) / (total - weight_error) +
                     kStoringError +
                     std::abs(voxel.tsdf - value) * gain * weight_error / (total * (total - weight_error));
  voxel.tsdf = (voxel.tsdf * voxel.weight + value * gain) / total;
  voxel.weight = std::min(total, options_.max_weight);
  // Whole weights are held exactly, and so is the cap where all that rounding can make of it reaches it.
  if (options_.noise.growth > 0 || options_.noise.bias_growth > 0)
    voxel.weight_error += kWeightUnit / 2 + 1e-6 * gain;
  if (total - voxel.weight_error >= options_.max_weight) voxel.weight_error = 0;
  ++voxel.updates;
  if (rgb.empty() || distance >= options_.truncation) return;
  const Eigen::Vector3d seen(rgb[pixel] & 255, rgb[pixel] >> 8 & 255, rgb[pixel] >> 16 & 255);
  const int weight = std::min(voxel.colour_updates++, kColourWeightCap);
  voxel.rgb = (voxel.rgb * weight + seen) / (weight + 1);
}

Comparison compare(const TsdfMap& expected, const TsdfContents& contents) {
  Comparison result;
  const double sensing_error = 8 * kPositionError / expected.options().truncation;
  for (std::size_t b = 0; b < contents.blocks.size(); ++b) {
    const auto found = expected.blocks().find(contents.blocks[b]);
    if (found == expected.blocks().end()) {
      result.add(INFINITY, where(contents.blocks[b], 0) + ": not expected");
      continue;
    }
    for (int i = 0; i < 512; ++i) {
      const Voxel& voxel = found->second[i];
      if (voxel.uncertain) {
        ++result.skipped;
        continue;
      }
      const double tsdf = contents.tsdf[512 * b + i], weight = contents.weight[512 * b + i];
      const double tolerance = sensing_error + voxel.tsdf_error;
      const bool same_weight = std::abs(weight - voxel.weight) < voxel.weight_error + 1e-3;
      result.add(same_weight ? std::abs(tsdf - voxel.tsdf) / tolerance : INFINITY,
                 where(found->first, i) + ": tsdf " + std::to_string(tsdf) + " weight " +
                     std::to_string(weight) + ", expected " + std::to_string(voxel.tsdf) + " and " +
                     std::to_string(voxel.weight));
    }
  }
  return result;
}

Comparison compareColour(const TsdfMap& expected, const TsdfContents& contents) {
  Comparison result;
  for (std::size_t b = 0; b < contents.blocks.size(); ++b) {
    const std::vector<Voxel>& voxels = expected.blocks().at(contents.blocks[b]);
    for (int i = 0; i < 512; ++i) {
      const Voxel& voxel = voxels[i];
      if (voxel.uncertain || voxel.colour_uncertain) {
        ++result.skipped;
        continue;
      }
      const std::uint32_t word = contents.colour[512 * b + i];
      const Eigen::Vector3d rgb(word & 255, word >> 8 & 255, word >> 16 & 255);
      const double tolerance = accumulated(kColourStoringError, voxel.colour_updates, kColourWeightCap);
      const bool same_weight = int(word >> 24) == std::min(voxel.colour_updates, kColourWeightCap);
      result.add(same_weight ? (rgb - voxel.rgb).cwiseAbs().maxCoeff() / tolerance : INFINITY,
                 where(contents.blocks[b], i) + ": colour " + std::to_string(word) + ", expected red " +
                     std::to_string(voxel.rgb.x()) + " of " + std::to_string(voxel.colour_updates) +
                     " updates");
    }
  }
  return result;
}

}  // namespace rosefusion::reference
