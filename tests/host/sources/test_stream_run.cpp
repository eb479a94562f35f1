// A sequence that came through a failing network gives the trajectory that it gives from disk, bit by bit.
#include <future>

#include "host/run/reconstruction.h"
#include "host/sources/stream.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"
#include "tests/host/sources/cutting_proxy.h"
#include "tests/host/sources/memory_sequence.h"

namespace rosefusion::testing {
namespace test_stream_run {

class StreamRun : public ValidatingDevice {
 protected:
  static Trajectory track(FrameSource& source) {
    Pipeline pipeline(device(), quickSettings(), source.info().intrinsics,
                      source.info().depth_units_per_metre);
    return trajectoryOf(reconstruct(source, pipeline));
  }
};

TEST_F(StreamRun, BrokenConnectionsKeepTheTrajectory) {
  const SynthSequence& synth = shortSequence();
  MemorySequence sequence(synth.frames, synth.intrinsics, synth.depth_units_per_metre);
  SequenceSource from_disk(sequence, {});
  const Trajectory expected = track(from_disk);

  StreamReceiver receiver("tcp://127.0.0.1:*", {});
  CuttingProxy proxy(portOf(receiver.endpoint()), 100'000, 3);
  auto sending = std::async(std::launch::async, [&] {
    StreamSender sender(proxy.endpoint(), sequence.info(), {});
    for (const Frame& frame : synth.frames) sender.send(frame, {});
    return sender.finish({});
  });
  ASSERT_TRUE(receiver.waitForStream({}));
  const Trajectory received = track(receiver);
  EXPECT_TRUE(sending.get());
  EXPECT_EQ(proxy.cutsMade(), 3);
  ASSERT_EQ(received.size(), expected.size());
  ASSERT_EQ(received.size(), synth.frames.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(received[i].timestamp, expected[i].timestamp);
    EXPECT_EQ(received[i].world_from_camera.matrix(), expected[i].world_from_camera.matrix()) << i;
  }
}

}  // namespace test_stream_run
}  // namespace rosefusion::testing
