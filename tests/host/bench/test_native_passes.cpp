// The native loops against formulas written out one by one, on a plane; and that a difference is noticed.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/bench/native_integrate.h"
#include "host/bench/native_pairs.h"
#include "host/bench/native_preprocess.h"
#include "host/bench/native_raycast.h"
#include "host/bench/native_refine.h"
#include "tests/reference/footprint.h"
#include "tests/reference/preprocess.h"

namespace rosefusion::testing {
namespace test_native_passes {

constexpr float kVoxel = 0.05f, kTruncation = 0.15f;
constexpr double kPlane = 1.02;  // metres in front of a camera at the origin

/// 90 x 70: no multiple of what the loops take at once.
shader::CameraIntrinsics camera() {
  return {glm::vec4(80, 82, 44.5f, 34.5f), glm::ivec4(90, 70, 0, 0)};
}

/// The plane z = kPlane, in front of which it is free, in blocks around it; all with that weight.
VolumeContents plane(float weight) {
  VolumeContents out;
  out.blocks.emplace_back(0);
  for (int z = 1; z < 4; ++z)
    for (int y = -3; y < 3; ++y)
      for (int x = -3; x < 3; ++x) out.blocks.emplace_back(x, y, z, 0);
  out.tsdf.assign(out.blocks.size() * shader::kBlockVoxels, 1);
  out.weight.assign(out.tsdf.size(), 0);
  for (std::size_t i = shader::kBlockVoxels; i < out.tsdf.size(); ++i) {
    const double z = (out.blocks[i / 512].z * 8 + static_cast<int>(i % 512 / 64) + 0.5) * kVoxel;
    out.tsdf[i] = static_cast<float>(std::clamp((kPlane - z) / kTruncation, -1.0, 1.0));
    out.weight[i] = weight;
  }
  return out;
}

std::vector<std::uint16_t> noisyDepths() {
  std::mt19937 random(5);
  std::vector<std::uint16_t> raw;
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 90; ++x) {
      const double z = x < 30 ? 1.5 : 1 / (0.6 + 0.002 * x - 0.001 * y);  // a step, and a slanted plane
      const int value = static_cast<int>(1000 * z) + static_cast<int>(random() % 7) - 3;
      raw.push_back(random() % 20 == 0 ? 0 : static_cast<std::uint16_t>(value));
    }
  return raw;
}

TEST(NativePreprocess, GivesTheReferencesDepthsPointsAndTiles) {
  const std::vector<std::uint16_t> raw = noisyDepths();
  const Intrinsics k{90, 70, 80, 82, 44.5, 34.5};
  NativePreprocessing how{camera(), 0.001f, 0.3f, 6, 4, {0.004f, 0.002f, 0}, 0.08f};
  reference::DepthSensor sensor{0.001, 0.3, 6, 4, 2, {0.004, 0.002}};
  reference::FootprintOptions footprint;
  footprint.voxel_size = 0.08;
  footprint.noise = sensor.noise;
  const reference::PointImage own = reference::preprocess(raw, k, sensor);
  for (const bool planes : {false, true}) {
    how.voxel_size = planes ? 0.08f : 0;
    const reference::PointImage expected = planes ? reference::footprint(own, raw, k, footprint) : own;
    NativeFrame frame, again;
    nativePreprocess(how, raw, frame, 1);
    nativePreprocess(how, raw, again, 3);
    EXPECT_EQ(frame.depth, again.depth);
    ASSERT_EQ(frame.depth.size(), raw.size());
    std::size_t compared = 0, changed = 0;
    std::vector<float> farthest(6 * 5, 0.0f);
    for (std::size_t i = 0; i < raw.size(); ++i) {
      float& tile = farthest[i / 90 / 16 * 6 + i % 90 / 16];
      tile = std::max(tile, frame.depth[i]);
      if (expected.uncertain[i]) continue;
      ++compared;
      changed += std::abs(expected.depth[i] - raw[i] * 0.001) > 1e-5;
      EXPECT_NEAR(frame.depth[i], expected.depth[i], 2e-5) << "pixel " << i << (planes ? " with planes" : "");
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(frame.points[i][axis], expected.points[i][axis], 2e-5) << "pixel " << i;
    }
    EXPECT_EQ(frame.tiles, farthest);
    EXPECT_GT(compared, raw.size() * 9 / 10);
    EXPECT_GT(changed, planes ? raw.size() / 2 : 50);  // planes move depths, edges are left out
  }
}

TEST(NativeIntegrate, AddsTheDistanceAlongTheRay) {
  NativeVolume volume(plane(2), kVoxel);
  const NativeVolume before = volume;
  std::vector<float> depth(90 * 70, 1.0f);
  depth[0] = 0;
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 1; slot < volume.blocks.size(); ++slot) slots.push_back(slot);
  const NativeFusion fusion{camera(), glm::mat4(1), {0.005f, 0.002f, 0.003f}, kTruncation, 128, false};
  nativeIntegrate(volume, slots, depth, fusion, 2);
  const double noise = 0.005 + 0.002 * 0.36, variance = noise * noise + 0.003 * 0.003,
               gain = 0.005 * 0.005 / variance;
  std::size_t told = 0, kept = 0;
  for (std::size_t i = 512; i < volume.codes.size(); ++i) {
    const glm::ivec4 block = volume.blocks[i / 512];
    const double x = (block.x * 8 + int(i % 8) + 0.5) * kVoxel,
                 y = (block.y * 8 + int(i / 8 % 8) + 0.5) * kVoxel,
                 z = (block.z * 8 + int(i / 64 % 8) + 0.5) * kVoxel;
    const double across = 80 * x / z + 45, down = 82 * y / z + 35, u = std::floor(across),
                 v = std::floor(down);
    const double distance = (1 / z - 1) * std::sqrt(x * x + y * y + z * z);
    // Rounding decides these.
    if (std::min({std::abs(across - std::round(across)), std::abs(down - std::round(down)),
                  std::abs(distance + kTruncation)}) < 1e-4)
      continue;
    const bool seen = u >= 0 && v >= 0 && u < 90 && v < 70 && (u > 0 || v > 0) && distance >= -kTruncation;
    double tsdf = before.codes[i] / 32767.0, weight = 2;
    if (seen) {
      tsdf = (tsdf * 2 + std::min(distance / kTruncation, 1.0) * gain) / (2 + gain);
      weight = 2 + gain;
    }
    ++(seen ? told : kept);
    EXPECT_NEAR(volume.codes[i] / 32767.0, tsdf, 5e-5) << "voxel " << i;
    EXPECT_NEAR(volume.units[i] / 256.0, weight, 3e-3) << "voxel " << i;
  }
  EXPECT_GT(told, 3000u);
  EXPECT_GT(kept, 5000u);
}

TEST(NativeIntegrate, OfThinWallsTheLargerDistanceStays) {
  for (const bool thin_walls : {false, true}) {
    NativeVolume volume(plane(2), kVoxel);
    const std::vector<float> depth(90 * 70, 1.3f);  // all of the plane's band is free space here
    std::vector<std::uint32_t> slots;
    for (std::uint32_t slot = 1; slot < volume.blocks.size(); ++slot) slots.push_back(slot);
    nativeIntegrate(volume, slots, depth, {camera(), glm::mat4(1), {}, kTruncation, 128, thin_walls}, 1);
    // Block (0, 0, 2): its fifth layer is behind the plane, and told to be free.
    std::size_t slot = 1;
    while (glm::ivec3(volume.blocks[slot]) != glm::ivec3(0, 0, 2)) ++slot;
    const double behind = (kPlane - (16 + 5.5) * kVoxel) / kTruncation;
    EXPECT_NEAR(volume.codes[slot * 512 + 5 * 64] / 32767.0, thin_walls ? 1 : (2 * behind + 1) / 3, 1e-3);
  }
}

TEST(NativeRefine, SumsThePlanesNormalEquations) {
  const NativeVolume volume(plane(4), kVoxel);
  std::vector<glm::vec4> points;
  for (int i = 0; i < 37; ++i) points.emplace_back(0.01 * i - 0.2, 0.1 - 0.005 * i, 1.03, 1);
  points.emplace_back(0, 0, 1.6, 1);  // reads no distance
  const shader::CameraIntrinsics k = camera();
  const glm::vec4 f = k.focal_centre;
  const glm::mat4 image(f.x, 0, 0, 0, 0, f.y, 0, 0, f.z, f.w, 1, 0, 0, 0, 0, 1);
  const shader::RefineCandidate candidate{glm::mat4(1), image};
  const RefineWeights weights{0.02f, {0.005f, 0, 0}, 0.01f, true};
  for (const int threads : {1, 2}) {
    const RefineSums sums =
        nativeRefine(volume, kTruncation, points, {{candidate, candidate}}, k, weights, threads)[1];
    const double residual = kPlane - 1.03, variance = 0.005 * 0.005 + 0.01 * 0.01 / 4,
                 weight = 0.005 * 0.005 / variance;
    const double cost_weight = 1 / (1 + variance / 4e-4), no_surface = 0.02 * (kTruncation - 0.01);
    EXPECT_NEAR(sums[shader::kRefineUsable], 37, 1e-6);
    EXPECT_NEAR(sums[shader::kRefineClose], 37, 1e-6);
    EXPECT_NEAR(sums[shader::kRefineHessian + 11], 37 * weight, 37 * weight * 1e-3);  // z, z
    EXPECT_NEAR(sums[shader::kRefineHessian], 0, 1e-4);
    EXPECT_NEAR(sums[shader::kRefineGradient + 2], -37 * weight * residual, 37 * weight * 2e-5);
    const double far_weight = 1 / (1 + 0.005 * 0.005 / 4e-4);  // the model says nothing of it
    EXPECT_NEAR(sums[shader::kRefineCost],
                37 * cost_weight * residual * residual / 2 + far_weight * no_surface, 5e-5);
    EXPECT_NEAR(sums[shader::kRefineMostCost], (37 * cost_weight + far_weight) * no_surface, 1e-4);
  }
}

TEST(NativeRaycast, SeesThePlaneAsDeepAsItIs) {
  const NativeVolume volume(plane(4), kVoxel);
  NativeView view, again;
  nativeRaycast(volume, kTruncation, camera(), {.far = 3}, view, 1);
  nativeRaycast(volume, kTruncation, camera(), {.far = 3}, again, 2);
  EXPECT_EQ(view.picture, again.picture);
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 90; ++x) {
      const std::size_t i = std::size_t(y) * 90 + x;
      EXPECT_NEAR(view.depth[i], kPlane, 0.002) << x << " " << y;
      const auto u = static_cast<std::int16_t>(view.normals[i]),
                 v = static_cast<std::int16_t>(view.normals[i] >> 16);
      EXPECT_GE(std::abs(u), 32600);  // z = -1 lies in the square's corners
      EXPECT_GE(std::abs(v), 32600);
    }
  EXPECT_EQ(view.picture[35 * 90 + 45] & 0xFF,
            209u);  // clay, lit from the camera: 0.8 * 0.9 + 0.1
  glm::mat4 away(1);
  away[0][0] = away[2][2] = -1;
  nativeRaycast(volume, kTruncation, camera(), {.world_from_camera = away, .far = 3}, view, 2);
  EXPECT_EQ(view.depth, std::vector<float>(90 * 70, 0.0f));
}

TEST(NativePairs, DifferencesAreCountedAndRefused) {
  const std::vector<float> native(1000, 1.0f);
  std::vector<float> device = native;
  EXPECT_EQ(shareApart(device, native, 0.01), 0);
  device[3] += 0.009f;
  device[4] += 0.02f;
  device[5] = std::nanf("");
  EXPECT_DOUBLE_EQ(shareApart(device, native, 0.01), 0.002);
  device.pop_back();
  EXPECT_DOUBLE_EQ(shareApart(device, native, 0.01), 0.003);
  EXPECT_EQ(requireShare("GPU", "refine", 0.002, 0.002), 0.002);
  try {
    requireShare("GPU", "refine", 0.003, 0.002);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("GPU"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("refine"), std::string::npos);
  }
}

TEST(NativePairs, RatiosAreThoseOfThePairs) {
  NativePairs pairs;
  std::string order;
  for (int i = 0; i < 4; ++i)
    pairs.measure(
        i > 0, [&] { order += 'd'; }, [&] { order += 'n'; });
  EXPECT_EQ(order, "dnnddnnd");
  EXPECT_GT(pairs.figures().ratio, 0);
}

}  // namespace test_native_passes
}  // namespace rosefusion::testing
