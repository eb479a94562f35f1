// Pass preprocess against its reference.
#include <algorithm>
#include <cmath>

#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_preprocess {

class Preprocess : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    sequence_ = makeSequence(GetParam(), 1, 11);
    // Depths on both sides of the limits and the two invalid codes, in odd and even pixels.
    const std::uint16_t edges[] = {0, 65535, 1, 1499, 1501, 29999, 30001, 65534, 0, 1501};
    std::copy(std::begin(edges), std::end(edges), sequence_.images[0].depth.begin());
    run(sequence_.images[0].depth);
  }
  void run(const std::vector<std::uint16_t>& raw) {
    PreprocessPass pass(device(), onDevice(GetParam()));
    Recorder recorder(device());
    const auto& sensor = sequence_.sensor;
    pass.record(recorder, raw, sensor.metres_per_unit, sensor.min_depth, sensor.max_depth, sensor.edge_sigmas,
                onDevice(sensor.noise));
    recorder.submit();
    raw_ = raw;
    depth_ = readBack<float>(device(), pass.frame().depth, raw.size());
    points_ = readBack<float>(device(), pass.frame().points, 4 * raw.size());
    const DepthReach reach = pass.frame().reach();
    farthest_.assign(reach.farthest.begin(), reach.farthest.end());
    columns_ = reach.columns;
  }
  reference::Comparison compareWith(const Intrinsics& camera, const reference::DepthSensor& sensor) const {
    return compare(preprocess(raw_, camera, sensor), depth_, points_);
  }

  Sequence sequence_;
  std::vector<std::uint16_t> raw_;
  std::vector<float> depth_, points_, farthest_;
  int columns_ = 0;
};

TEST_P(Preprocess, AgreesWithTheReference) {
  const auto result = compareWith(GetParam(), sequence_.sensor);
  EXPECT_TRUE(agrees(result));
  EXPECT_EQ(result.compared, std::size_t(GetParam().width) * GetParam().height);
}

TEST_P(Preprocess, EachTileTellsItsFarthestDepth) {
  const int width = GetParam().width, height = GetParam().height;
  const auto expected = [&](int side) {
    const int columns = (width + side - 1) / side;
    std::vector<float> tiles(std::size_t(columns) * ((height + side - 1) / side));
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        float& tile = tiles[std::size_t(v / side) * columns + u / side];
        tile = std::max(tile, depth_[std::size_t(v) * width + u]);
      }
    return tiles;
  };
  EXPECT_EQ(columns_, (width + 15) / 16);
  EXPECT_EQ(farthest_, expected(16));
  EXPECT_NE(farthest_, expected(15));
  // One pixel each, in the corners, of an image that is invalid else.
  std::vector<std::uint16_t> raw(depth_.size());
  raw.front() = raw.back() = 10000;
  run(raw);
  EXPECT_EQ(farthest_, expected(16));
  EXPECT_EQ(std::count(farthest_.begin(), farthest_.end(), 0.0f), std::ssize(farthest_) - 2);
}

TEST_P(Preprocess, ComparisonSeesAWrongCoefficient) {
  Intrinsics camera = GetParam();
  camera.fx *= 1.0001;
  EXPECT_TRUE(differs(compareWith(camera, sequence_.sensor)));
  camera = GetParam();
  camera.cy += 0.01;
  EXPECT_TRUE(differs(compareWith(camera, sequence_.sensor)));
  reference::DepthSensor sensor = sequence_.sensor;
  sensor.metres_per_unit *= 1.00001;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  sensor = sequence_.sensor;
  sensor.min_depth = 0.301;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  sensor = sequence_.sensor;
  sensor.max_depth = 5.999;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  sensor.max_depth = 20;  // 65534 units would be valid
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
}

// Low enough that the spheres' rims bend by less and by more. Float values, as the pass gets them.
void filterEdges(reference::DepthSensor& sensor) {
  sensor.edge_sigmas = 2;
  sensor.noise = {.floor = 0.001f, .growth = 0.0005f};
}
// Pixels whose bend is within rounding, some micrometres, of a threshold of millimetres.
constexpr double kSkippedShare = 0.005;

TEST_P(Preprocess, EdgesAgreeWithTheReference) {
  const auto all = sequence_.sensor;
  filterEdges(sequence_.sensor);
  run(sequence_.images[0].depth);
  EXPECT_TRUE(agrees(compareWith(GetParam(), sequence_.sensor), kSkippedShare));
  EXPECT_TRUE(differs(compareWith(GetParam(), all)));
  const auto valid = std::count_if(depth_.begin(), depth_.end(), [](float z) { return z > 0; });
  EXPECT_GT(valid, GetParam().width * GetParam().height / 2);
}

TEST_P(Preprocess, ComparisonSeesAWrongEdgeCoefficient) {
  filterEdges(sequence_.sensor);
  run(sequence_.images[0].depth);
  reference::DepthSensor sensor = sequence_.sensor;
  sensor.edge_sigmas *= 1.05;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  sensor = sequence_.sensor;
  sensor.noise.floor *= 1.1;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  sensor = sequence_.sensor;
  sensor.noise.growth *= 1.1;
  EXPECT_TRUE(differs(compareWith(GetParam(), sensor)));
  for (const int reach : {1, 3}) {
    sensor = sequence_.sensor;
    sensor.edge_reach = reach;
    EXPECT_TRUE(differs(compareWith(GetParam(), sensor))) << "reach " << reach;
  }
}

TEST_P(Preprocess, EdgesNeedBothNeighboursOfAnAxis) {
  filterEdges(sequence_.sensor);
  const int width = GetParam().width, height = GetParam().height;
  std::vector<std::uint16_t> raw(std::size_t(width) * height, 10000);  // a wall at 2 m
  const auto at = [&](int u, int v) -> std::uint16_t& { return raw[std::size_t(v) * width + u]; };
  const auto kept = [&](int u, int v) { return depth_[std::size_t(v) * width + u] > 0; };
  constexpr std::uint16_t kSpike = 10250;  // 5 cm behind it; the threshold there is 4.6 mm
  at(20, 20) = kSpike;                     // seen along both axes
  at(1, 40) = at(width - 2, 40) = kSpike;  // no neighbour along x
  at(60, 1) = at(60, height - 2) = kSpike;
  for (const int u : {1, width - 2})  // no neighbours at all
    for (const int v : {1, height - 2}) at(u, v) = kSpike;
  at(40, 40) = kSpike;  // an invalid neighbour along x
  at(42, 40) = 0;
  at(80, 80) = kSpike;  // an invalid one along either axis
  at(78, 80) = 65535;
  at(80, 82) = 0;
  run(raw);
  EXPECT_TRUE(agrees(compareWith(GetParam(), sequence_.sensor)));
  EXPECT_FALSE(kept(20, 20));
  for (const int side : {-2, 2}) {  // those that have the spike as a neighbour leave its plane, too
    EXPECT_FALSE(kept(20 + side, 20));
    EXPECT_FALSE(kept(20, 20 + side));
  }
  EXPECT_TRUE(kept(21, 20) && kept(20, 19) && kept(22, 22));
  EXPECT_FALSE(kept(1, 40) || kept(width - 2, 40) || kept(60, 1) || kept(60, height - 2));
  for (const int u : {1, width - 2})
    for (const int v : {1, height - 2}) EXPECT_TRUE(kept(u, v)) << u << ", " << v;
  EXPECT_FALSE(kept(40, 40));
  EXPECT_TRUE(kept(80, 80));
}

TEST_P(Preprocess, ASteepPlaneHasNoEdges) {
  filterEdges(sequence_.sensor);
  std::vector<std::uint16_t> raw;
  for (int v = 0; v < GetParam().height; ++v)
    for (int u = 0; u < GetParam().width; ++u)
      raw.push_back(std::uint16_t(std::lround(5000 / (1 - 0.005 * u))));  // 1 to 5 m, 4 to 10 cm a pixel
  run(raw);
  EXPECT_TRUE(agrees(compareWith(GetParam(), sequence_.sensor)));
  EXPECT_EQ(std::count(depth_.begin(), depth_.end(), 0.0f), 0);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Preprocess, kBothCameras, cameraName);

class PreprocessInput : public ValidatingDevice {};

TEST_F(PreprocessInput, TheInvalidCodesAreInvalidAtAnyRange) {
  Sequence sequence = makeSequence(kOddCamera, 1, 12);
  sequence.sensor.min_depth = 0;
  sequence.sensor.max_depth = 20;  // 65535 units are 13 m
  const auto& sensor = sequence.sensor;
  const std::vector<std::uint16_t>& raw = sequence.images[0].depth;
  PreprocessPass pass(device(), onDevice(kOddCamera));
  Recorder recorder(device());
  pass.record(recorder, raw, sensor.metres_per_unit, sensor.min_depth, sensor.max_depth);
  recorder.submit();
  const auto depth = readBack<float>(device(), pass.frame().depth, raw.size());
  const auto points = readBack<float>(device(), pass.frame().points, 4 * raw.size());
  EXPECT_TRUE(agrees(compare(preprocess(raw, kOddCamera, sensor), depth, points)));
  EXPECT_GT(std::count(raw.begin(), raw.end(), 65535), 100);
}

TEST_F(PreprocessInput, WrongImageSizeIsAProgrammingError) {
  PreprocessPass pass(device(), onDevice(kPlainCamera));
  Recorder recorder(device());
  const std::vector<std::uint16_t> depth(160 * 120 - 1);
  EXPECT_TRUE(throwsDeviceError([&] { pass.record(recorder, depth, 0.001f, 0.3f, 5.0f); },
                                DeviceErrorCode::Programming, {"camera's size"}));
  EXPECT_EQ(pass.colourWords().size(), 160u * 120u);
}

}  // namespace test_preprocess
}  // namespace rosefusion::testing
