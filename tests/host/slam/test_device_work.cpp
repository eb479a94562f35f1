// How much the device is asked for a frame: what is measured in submits, dispatches and copies stays small.
#include "host/slam/pipeline.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_device_work {

class DeviceWorkTest : public ValidatingDevice {
 protected:
  /// Per frame, without the first three, which make buffers and blocks.
  static DeviceWork perFrame(const Settings& settings) {
    const SynthSequence& sequence = shortSequence();
    Pipeline pipeline(device(), settings, sequence.intrinsics, sequence.depth_units_per_metre);
    constexpr std::size_t kLeftOut = 3;
    DeviceWork before;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      if (i == kLeftOut) before = device().work();
      EXPECT_NE(pipeline.processFrame(sequence.frames[i]).status, TrackingStatus::Lost) << "frame " << i;
    }
    pipeline.finish();
    const DeviceWork after = device().work();
    const std::uint64_t frames = sequence.frames.size() - kLeftOut;
    return {(after.submits - before.submits) / frames, (after.dispatches - before.dispatches) / frames,
            (after.copied_bytes - before.copied_bytes) / frames};
  }
};

// Measured on lavapipe 2026-12-01: 20 and 32 submits, 60 and 52 dispatches, under 1 KB copied. A GPU needs
// fewer submits by default (PoseRefiner evaluates several steps together there).
TEST_F(DeviceWorkTest, OfThePapersSearchIsBounded) {
  const DeviceWork work = perFrame(quickSettings());
  RecordProperty("submits", static_cast<int>(work.submits));
  EXPECT_LE(work.submits, 22u);
  EXPECT_LE(work.dispatches, 66u);
  EXPECT_LE(work.copied_bytes, 8192u) << "no table is copied as a whole";
}

TEST_F(DeviceWorkTest, OfTheDefaultSearchIsBounded) {
  const DeviceWork work = perFrame(loadSettings("default"));
  RecordProperty("submits", static_cast<int>(work.submits));
  EXPECT_LE(work.submits, 35u);
  EXPECT_LE(work.dispatches, 66u);
  EXPECT_LE(work.copied_bytes, 8192u) << "no table is copied as a whole";
}

}  // namespace test_device_work
}  // namespace rosefusion::testing
