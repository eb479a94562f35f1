#include "host/bench/pass_agreement.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "host/bench/native_pairs.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

// Depths and points: a tenth of a millimetre. Hits in voxels, shades of 255.
constexpr double kDepthTolerance = 1e-4;
constexpr double kTsdfTolerance = 0.01, kWeightTolerance = 0.02;
constexpr double kSumTolerance = 1e-3;
constexpr double kHitTolerance = 0.1, kShadeTolerance = 4;

/// The sums of a candidate in units in which a point weighs alike: the diagonal's, or what bounds them.
std::vector<float> comparable(std::span<const RefineSums> all, std::span<const RefineSums> unit,
                              float huber) {
  using namespace shader;
  std::vector<float> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RefineSums &sums = all[i], &of = unit[i];
    std::array<double, 6> length;
    std::size_t entry = kRefineHessian;
    for (int row = 0; row < 6; entry += 6 - row++) length[row] = std::sqrt(std::max(of[entry], 1e-12));
    entry = kRefineHessian;
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column)
        out.push_back(static_cast<float>(sums[entry++] / (length[row] * length[column])));
      const double points = std::sqrt(std::max(of[kRefineUsable], 1.0)) * huber;
      out.push_back(static_cast<float>(sums[kRefineGradient + row] / (length[row] * points)));
    }
    for (const std::size_t k : {kRefineCost, kRefineMostCost, kRefineCostWeight, kRefineUsable, kRefineClose})
      out.push_back(static_cast<float>(sums[k] / std::max(of[k], 1e-12)));
  }
  return out;
}

std::vector<float> bytesOf(std::span<const std::uint32_t> words) {
  std::vector<float> out;
  for (const std::uint32_t word : words)
    for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<float>(word >> shift & 0xFF));
  return out;
}

std::vector<float> numbersOf(std::span<const glm::vec4> points) {
  std::vector<float> out;
  for (const glm::vec4& p : points) out.insert(out.end(), {p.x, p.y, p.z, p.w});
  return out;
}

}  // namespace

double pixelsApart(std::span<const float> depth, std::span<const glm::vec4> points,
                   std::span<const float> farthest, const NativeFrame& native) {
  return std::max({shareApart(depth, native.depth, kDepthTolerance),
                   shareApart(numbersOf(points), numbersOf(native.points), kDepthTolerance),
                   shareApart(farthest, native.tiles, kDepthTolerance)});
}

double voxelsApart(const NativeVolume& device, const NativeVolume& native, float max_weight) {
  const auto asFloats = [](const auto& numbers, float unit) {
    std::vector<float> out;
    for (const auto number : numbers) out.push_back(static_cast<float>(number) * unit);
    return out;
  };
  const float unit = 1 / (shader::kWeightOne * max_weight);
  return std::max(
      shareApart(asFloats(device.codes, kTsdfOfCode), asFloats(native.codes, kTsdfOfCode), kTsdfTolerance),
      shareApart(asFloats(device.units, unit), asFloats(native.units, unit), kWeightTolerance));
}

double sumsApart(std::span<const RefineSums> device, std::span<const RefineSums> native, float huber) {
  return shareApart(comparable(device, native, huber), comparable(native, native, huber), kSumTolerance);
}

double raysApart(std::span<const std::uint32_t> surface, std::span<const std::uint32_t> preview,
                 const NativeView& native, double voxel_size) {
  std::vector<float> depth;
  for (std::size_t i = 0; i < native.depth.size(); ++i)
    depth.push_back(std::bit_cast<float>(surface[2 * i + 1]));
  return std::max(shareApart(depth, native.depth, kHitTolerance * voxel_size),
                  shareApart(bytesOf(preview), bytesOf(native.picture), kShadeTolerance));
}

double requireAgreement(const std::string& device_name, std::span<const float> device,
                        std::span<const float> native, std::size_t points) {
  double worst = 0, sum = 0;
  for (std::size_t i = 0; i < native.size(); ++i) {
    const double difference = std::abs(double(device[i]) - native[i]);
    worst = std::max(worst, std::isnan(difference) ? 2.0 : difference);
    sum += difference;
  }
  const double mean = sum / static_cast<double>(native.size());
  if (worst <= lossTolerance(points) && mean <= kMeanLossTolerance) return worst;
  throw std::runtime_error(printed(
      "%s computes other losses than the native loop: %.2e at most and %.2e in the mean differ, where "
      "%.2e and %.2e are allowed; do not trust this device's results.",
      device_name.c_str(), worst, mean, lossTolerance(points), kMeanLossTolerance));
}

}  // namespace rosefusion
