// Passes depth_moments and footprint against their reference, and what they are for.
#include "tests/reference/footprint.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_footprint {

// Cells or pixels within rounding of one of the limits.
constexpr double kSkippedShare = 0.02;
// Of a depth, relative: sums of up to 1024 inverse depths in single precision.
constexpr double kTolerance = 5e-6;

/// A depth image by pixel, in units of 0.2 mm; metres <= 0 is a hole.
std::vector<std::uint16_t> imageOf(const Intrinsics& camera, const std::function<double(int, int)>& metres) {
  std::vector<std::uint16_t> raw;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      raw.push_back(static_cast<std::uint16_t>(std::lround(5000 * std::max(metres(u, v), 0.0))));
  return raw;
}

/// A plane from 0.8 m on the left to 1.6 m on the right of an image 160 pixels wide.
double slanted(int u) {
  return 0.8 / (1 - u / 320.0);
}

class Footprint : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void run(const std::vector<std::uint16_t>& raw) {
    raw_ = raw;
    PreprocessPass pass(device(), onDevice(GetParam()));
    Recorder recorder(device());
    pass.record(recorder, raw, static_cast<float>(sensor_.metres_per_unit), float(sensor_.min_depth),
                float(sensor_.max_depth), float(sensor_.edge_sigmas), onDevice(options_.noise),
                float(options_.voxel_size));
    recorder.submit();
    depth_ = readBack<float>(device(), pass.frame().depth, raw.size());
    points_ = readBack<float>(device(), pass.frame().points, 4 * raw.size());
  }
  /// A wall from 0.4 to 4 m whose noise differs from part to part, with a step, holes of one pixel in a grid
  /// and larger ones.
  std::vector<std::uint16_t> noisyScene() const {
    std::mt19937 random(52);
    std::normal_distribution<double> noise;
    return imageOf(GetParam(), [&](int u, int v) {
      const double z = 1 / (2.5 - u * (2.25 / 160)) + (v > 70 ? 0.2 : 0);
      const double deviation = options_.noise.deviation(z) * (0.9 + 0.1 * ((u / 8 + v / 8) % 8));
      const bool hole = (u % 3 == 1 && v % 5 < 2) || (u / 7 + v / 9) % 6 == 0;
      return hole ? 0 : z + deviation * noise(random);
    });
  }
  /// The same wall without a step, less noisy than is known, so that cells of all sizes are flat and a
  /// voxel's size alone decides.
  std::vector<std::uint16_t> calmScene() const {
    std::mt19937 random(55);
    std::normal_distribution<double> noise;
    return imageOf(GetParam(), [&](int u, int v) {
      const double z = 1 / (2.5 - u * (2.25 / 160) + v * (0.1 / 120));  // cells of many depths
      const bool hole = u % 3 == 1 && v % 5 < 2;
      return hole ? 0 : z + 0.7 * options_.noise.deviation(z) * noise(random);
    });
  }
  reference::Comparison compareWith(const reference::FootprintOptions& options, double focal = 1) const {
    Intrinsics camera = GetParam();
    camera.fx *= focal;
    const auto own = preprocess(raw_, GetParam(), sensor_);
    auto expected = footprint(own, raw_, camera, options);
    for (std::size_t i = 0; i < raw_.size(); ++i)
      expected.points[i] =
          GetParam().unproject(int(i) % camera.width, int(i) / camera.width, expected.depth[i]);
    return compare(expected, depth_, points_, kTolerance);
  }
  float depthAt(int u, int v) const { return depth_[std::size_t(v) * GetParam().width + u]; }

  reference::DepthSensor sensor_{.metres_per_unit = double(1 / 5000.0f)};
  // A voxel is 81 pixels at 0.4 m, 8 at 4 m: cells of all sizes.
  reference::FootprintOptions options_{.voxel_size = 0.25f, .noise = {.floor = 0.003f, .growth = 0.0004f}};
  std::vector<std::uint16_t> raw_;
  std::vector<float> depth_, points_;
};

TEST_P(Footprint, AgreesWithTheReference) {
  run(noisyScene());
  EXPECT_TRUE(agrees(compareWith(options_), kSkippedShare));
  // The scene holds what the pass has to tell apart.
  std::size_t filled = 0, left = 0, changed = 0, kept = 0;
  for (std::size_t i = 0; i < raw_.size(); ++i) {
    const bool hole = raw_[i] == 0 || raw_[i] == 65535;
    filled += hole && depth_[i] > 0;
    left += hole && depth_[i] == 0;
    const bool same = std::abs(depth_[i] - raw_[i] / 5000.0f) < 1e-6f;
    changed += !hole && depth_[i] > 0 && !same;
    kept += !hole && same;
  }
  for (const std::size_t count : {filled, left, changed, kept}) EXPECT_GT(count, 300u);
}

TEST_P(Footprint, ComparisonSeesAWrongCoefficient) {
  run(noisyScene());
  ASSERT_TRUE(agrees(compareWith(options_), kSkippedShare));
  const auto wrong = [&](const std::function<void(reference::FootprintOptions&)>& change) {
    reference::FootprintOptions options = options_;
    change(options);
    return differs(compareWith(options));
  };
  EXPECT_TRUE(wrong([](auto& o) { o.noise.floor *= 1.05; }));
  EXPECT_TRUE(wrong([](auto& o) { o.noise.growth *= 1.5; }));
  EXPECT_TRUE(wrong([](auto& o) { o.deviations = 5; }));
  EXPECT_TRUE(wrong([](auto& o) { o.most_variance = 0.9; }));
  EXPECT_TRUE(wrong([](auto& o) { o.smallest_cell = 2, o.sizes = 5; }));
  run(calmScene());
  ASSERT_TRUE(agrees(compareWith(options_), kSkippedShare));
  EXPECT_TRUE(wrong([](auto& o) { o.voxel_size *= 1.05; }));
  EXPECT_TRUE(wrong([](auto& o) { o.sizes = 3; }));
  EXPECT_TRUE(wrong([](auto& o) { o.sizes = 5; }));
  EXPECT_TRUE(differs(compareWith(options_, 1.05)));
}

TEST_P(Footprint, WithoutAVoxelEachPixelStandsForItself) {
  options_.voxel_size = 0;
  run(noisyScene());
  EXPECT_TRUE(agrees(compare(preprocess(raw_, GetParam(), sensor_), depth_, points_)));
}

TEST_P(Footprint, HolesOfOneOrTwoPixelsCostNothing) {
  options_.voxel_size = 0.02f;  // 1 to 3 pixels
  for (const bool grid : {true, false}) {
    run(imageOf(GetParam(), [&](int u, int v) {
      return (grid ? u % 2 == 1 && v % 3 == 0 : (u / 2 + 3 * v) % 5 == 0) ? 0 : slanted(u);
    }));
    for (int v = 0; v < GetParam().height / 4 * 4; ++v)  // of whole cells
      for (int u = 0; u < GetParam().width / 4 * 4; ++u)
        ASSERT_NEAR(depthAt(u, v), slanted(u), 0.0004) << u << ", " << v;  // two units of the image
  }
}

TEST_P(Footprint, NothingIsPutBetweenTwoSurfaces) {
  const auto step = [](int u) { return u < 75 ? 1.0 : 1.3; };
  run(imageOf(GetParam(), [&](int u, int v) { return (u + 2 * v) % 5 == 0 ? 0 : step(u); }));
  int holes = 0;
  for (int v = 0; v < GetParam().height; ++v)
    for (int u = 0; u < GetParam().width; ++u) {
      const double z = depthAt(u, v);
      if (z > 0) {
        EXPECT_NEAR(z, step(u), 0.01) << u << ", " << v;
      } else if (u < GetParam().width / 4 * 4 && v < GetParam().height / 4 * 4) {
        ++holes;
        EXPECT_LT(std::abs(u - 75), 4) << u << ", " << v;  // of the smallest cells that hold both
      }
    }
  EXPECT_GT(holes, 20);
}

TEST_P(Footprint, AThinRodStaysAndGrowsByNothing) {
  const auto rod = [](int u) { return u == 61 || u == 62; };
  run(imageOf(GetParam(), [&](int u, int) { return rod(u) ? 1.0 : 1.5; }));
  for (int v = 0; v < GetParam().height; ++v)
    for (int u = 0; u < GetParam().width; ++u)
      ASSERT_NEAR(depthAt(u, v), rod(u) ? 1.0 : 1.5, 0.0005) << u << ", " << v;
}

// A hole beside what is seen is the unknown, not more of the same.
TEST_P(Footprint, ASurfaceEndsWhereItsDepthsEnd) {
  options_.voxel_size = 0.02f;
  run(imageOf(GetParam(), [](int u, int) { return u < 74 ? 1.0 : 0.0; }));
  EXPECT_GT(depthAt(73, 50), 0);
  for (int u = 75; u < GetParam().width; ++u) EXPECT_EQ(depthAt(u, 50), 0) << u;
}

// A plane that runs away from the camera: the hole behind its last depth, of 5.7 m, would lie at 6.2 m;
// others at no number.
TEST_P(Footprint, APlaneGivesNoDepthBeyondTheRange) {
  run(imageOf(GetParam(), [](int u, int) { return u % 56 < 35 ? 1 / (0.6 - 0.0125 * (u % 56)) : 0.0; }));
  EXPECT_LE(*std::ranges::max_element(depth_), float(sensor_.max_depth));
  EXPECT_TRUE(agrees(compareWith(options_), kSkippedShare));
  options_.max_depth = 1e6;
  EXPECT_TRUE(differs(compareWith(options_))) << "or nothing runs away here";
}

TEST_P(Footprint, WhatIsNoHoleStaysInvalid) {
  sensor_.edge_sigmas = 4;
  options_.noise = {.floor = 0.002f};
  // A spike of 5 cm, which bends, and a depth out of range: the camera saw something there.
  run(imageOf(GetParam(), [](int u, int v) {
    return u == 40 && v == 40 ? 1.05 : u == 80 && v == 40 ? 7.0 : 1.0;
  }));
  EXPECT_EQ(depthAt(40, 40), 0);
  EXPECT_EQ(depthAt(80, 40), 0);
  EXPECT_GT(depthAt(41, 41), 0);
}

TEST_P(Footprint, NoiseIsAveragedOverAVoxel) {
  options_.voxel_size = 0.08f;  // 8 pixels at 1.25 m
  std::mt19937 random(53);
  std::normal_distribution<double> noise(0, 0.003);
  std::vector<double> truth;
  run(imageOf(GetParam(), [&](int u, int) {
    truth.push_back(1 / (0.8 + 0.0001 * u));
    return truth.back() + noise(random);
  }));
  double squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) squares += std::pow(depth_[i] - truth[i], 2);
  // A plane through 64 depths errs by sqrt(3 / 64) of one, on average.
  EXPECT_NEAR(std::sqrt(squares / double(truth.size())), 0.003 * std::sqrt(3 / 64.0), 0.0001);
}

// The model of an image with holes between all its pixels is that of the whole one.
TEST_P(Footprint, VoxelsBehindHolesAreKnown) {
  const Sequence whole = makeSequence(GetParam(), 1, 54);
  Sequence holed = whole;
  for (int v = 0; v < GetParam().height; ++v)
    for (int u = v % 2; u < GetParam().width; u += 2)
      holed.images[0].depth[std::size_t(v) * GetParam().width + u] = 0;
  const auto known = [&](const Sequence& sequence, float voxel_size) {
    SceneRun run(device(), sequence, {.voxel_size = 0.04f, .truncation = 0.12f});
    run.preprocess.record(run.recorder, sequence.images[0].depth, sequence.sensor.metres_per_unit,
                          sequence.sensor.min_depth, sequence.sensor.max_depth, 0, {}, voxel_size);
    run.recorder.submit();
    run.allocateBlocks(sequence.poses[0]);
    run.integrateDepth(sequence.poses[0]);
    const VolumeContents contents = run.volume.download();
    return std::count_if(contents.weight.begin(), contents.weight.end(), [](float w) { return w > 0; });
  };
  const auto all = known(whole, 0);
  EXPECT_LT(known(holed, 0), 0.6 * all);
  EXPECT_GT(known(holed, 0.04f), 0.9 * all);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Footprint, kBothCameras, cameraName);

}  // namespace test_footprint
}  // namespace rosefusion::testing
