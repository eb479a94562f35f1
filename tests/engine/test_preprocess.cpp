// Pass preprocess against its reference.
#include <algorithm>
#include <cmath>

#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace {

class Preprocess : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    sequence_ = makeSequence(GetParam(), 1, 11);
    // Depths on both sides of the limits and the two invalid codes, in odd and even pixels.
    const std::uint16_t edges[] = {0, 65535, 1, 1499, 1501, 29999, 30001, 65534, 0, 1501};
    std::copy(std::begin(edges), std::end(edges), sequence_.images[0].depth.begin());
    PreprocessPass pass(device(), onDevice(GetParam()));
    Recorder recorder(device());
    const auto& sensor = sequence_.sensor;
    pass.record(recorder, sequence_.images[0].depth, sensor.metres_per_unit, sensor.min_depth,
                sensor.max_depth);
    recorder.submit();
    const std::size_t pixels = sequence_.images[0].depth.size();
    depth_ = readBack<float>(device(), pass.depth(), pixels);
    points_ = readBack<float>(device(), pass.points(), 4 * pixels);
  }
  reference::Comparison compareWith(const Intrinsics& camera, const reference::DepthSensor& sensor) const {
    return compare(preprocess(sequence_.images[0].depth, camera, sensor), depth_, points_);
  }

  Sequence sequence_;
  std::vector<float> depth_, points_;
};

TEST_P(Preprocess, AgreesWithTheReference) {
  const auto result = compareWith(GetParam(), sequence_.sensor);
  EXPECT_TRUE(agrees(result));
  EXPECT_EQ(result.compared, std::size_t(GetParam().width) * GetParam().height);
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
  const auto depth = readBack<float>(device(), pass.depth(), raw.size());
  const auto points = readBack<float>(device(), pass.points(), 4 * raw.size());
  EXPECT_TRUE(agrees(compare(preprocess(raw, kOddCamera, sensor), depth, points)));
  EXPECT_GT(std::count(raw.begin(), raw.end(), 65535), 100);
}

TEST_F(PreprocessInput, WrongImageSizeIsAProgrammingError) {
  PreprocessPass pass(device(), onDevice(kPlainCamera));
  Recorder recorder(device());
  const std::vector<std::uint16_t> depth(160 * 120 - 1);
  const std::vector<std::uint32_t> rgb(160 * 120 + 1);
  EXPECT_TRUE(throwsDeviceError([&] { pass.record(recorder, depth, 0.001f, 0.3f, 5.0f); },
                                DeviceErrorCode::Programming, {"camera's size"}));
  EXPECT_TRUE(
      throwsDeviceError([&] { pass.setColour(rgb); }, DeviceErrorCode::Programming, {"camera's size"}));
}

}  // namespace
}  // namespace rosefusion::testing
