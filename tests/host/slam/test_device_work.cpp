// How much the device is asked for a frame: what is measured in submits, dispatches and copies stays small.
#include "host/slam/pipeline.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_device_work {

class WorkOnDevice : public ValidatingDevice {
 protected:
  struct Figures : DeviceWork {
    std::uint64_t iterations = 0;  ///< of the swarm, which end when they end, on each device elsewhere
  };
  /// Per frame, without the first three, which make buffers and blocks.
  static Figures perFrame(const Settings& settings) {
    const SynthSequence& sequence = shortSequence();
    Pipeline pipeline(device(), settings, sequence.intrinsics, sequence.depth_units_per_metre);
    constexpr std::size_t kLeftOut = 3;
    DeviceWork before;
    std::uint64_t iterations = 0;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      if (i == kLeftOut) before = device().work();
      const FrameResult result = pipeline.processFrame(sequence.frames[i]);
      EXPECT_NE(result.status, TrackingStatus::Lost) << "frame " << i;
      if (i >= kLeftOut) iterations += static_cast<std::uint64_t>(result.iterations);
    }
    pipeline.finish();
    const DeviceWork after = device().work();
    const std::uint64_t frames = sequence.frames.size() - kLeftOut;
    return {{(after.submits - before.submits) / frames, (after.dispatches - before.dispatches) / frames,
             (after.copied_bytes - before.copied_bytes) / frames},
            iterations / frames};
  }
};

// Measured on lavapipe 2026-12-01: 20 and 32 submits, 60 and 52 dispatches, under 1 KB copied. A GPU needs
// fewer submits by default (PoseRefiner evaluates several steps together there).
TEST_F(WorkOnDevice, OfThePapersSearchIsBounded) {
  const Figures work = perFrame(quickSettings());
  RecordProperty("submits", static_cast<int>(work.submits));
  EXPECT_LE(work.submits, work.iterations + 4) << work.iterations;
  EXPECT_LE(work.dispatches, 3 * work.iterations + 16) << work.iterations;
  EXPECT_LE(work.copied_bytes, 8192u) << "no table is copied as a whole";
}

TEST_F(WorkOnDevice, OfTheDefaultSearchIsBounded) {
  const Figures work = perFrame(loadSettings("default"));
  RecordProperty("submits", static_cast<int>(work.submits));
  EXPECT_LE(work.submits, 35u);
  EXPECT_LE(work.dispatches, 66u);
  EXPECT_LE(work.copied_bytes, 8192u) << "no table is copied as a whole";
}

}  // namespace test_device_work
}  // namespace rosefusion::testing
