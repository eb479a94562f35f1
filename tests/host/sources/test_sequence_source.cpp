// A recording as a source: every frame when it is taken, or those that a live camera would have given.
#include <thread>

#include "host/sources/sequence_source.h"
#include "tests/host/sources/memory_sequence.h"

namespace rosefusion::testing {
namespace test_sequence_source {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(SequenceSource, GivesEverySelectedFrame) {
  MemorySequence sequence(numberedFrames(10, 30), kSmallCamera);
  SequenceSource source(sequence, {3, 0});
  EXPECT_EQ(source.expectedFrames(), 4u);
  SourceFrame frame;
  for (const std::size_t index : {0u, 3u, 6u, 9u}) {
    ASSERT_EQ(source.next(frame, {}), SourceState::Frame);
    EXPECT_EQ(frame.index, index);
    EXPECT_EQ(frame.dropped, 0u);
    EXPECT_EQ(frame.frame.depth.at<std::uint16_t>(0, 0), 1000 * index);
  }
  EXPECT_EQ(source.next(frame, {}), SourceState::End);
  EXPECT_EQ(source.next(frame, {}), SourceState::End);
}

TEST(SequenceSource, RecordedPaceWaitsForTheCamera) {
  MemorySequence sequence(numberedFrames(5, 50), kSmallCamera);
  SequenceSource source(sequence, {}, Pace::Recorded);
  SourceFrame frame;
  const auto start = Clock::now();
  std::size_t given = 0, dropped = 0;
  while (source.next(frame, {}) == SourceState::Frame) {
    ++given;
    dropped += frame.dropped;
  }
  EXPECT_GE(Clock::now() - start, 80ms);  // the fifth frame comes 80 ms after the first
  EXPECT_EQ(given + dropped, 5u);
}

TEST(SequenceSource, RecordedPaceDropsFramesOfABusyTracker) {
  MemorySequence sequence(numberedFrames(40, 100), kSmallCamera);
  SequenceSource source(sequence, {}, Pace::Recorded);
  SourceFrame frame;
  std::size_t given = 0, dropped = 0, last = 0;
  while (source.next(frame, {}) == SourceState::Frame) {
    EXPECT_EQ(frame.index, given == 0 ? 0 : last + frame.dropped + 1);
    last = frame.index;
    ++given;
    dropped += frame.dropped;
    std::this_thread::sleep_for(55ms);  // five frames of the camera
  }
  EXPECT_EQ(given + dropped, 40u);
  EXPECT_EQ(last, 39u);
  EXPECT_GE(dropped, 25u);
}

TEST(SequenceSource, WaitingEndsWhenStopped) {
  auto frames = numberedFrames(2, 30);
  frames[1].timestamp += 3600;
  MemorySequence sequence(std::move(frames), kSmallCamera);
  SequenceSource source(sequence, {}, Pace::Recorded);
  SourceFrame frame;
  ASSERT_EQ(source.next(frame, {}), SourceState::Frame);
  const auto start = Clock::now();
  EXPECT_EQ(source.next(frame, [&] { return Clock::now() - start > 50ms; }), SourceState::Stopped);
  EXPECT_LT(Clock::now() - start, 5s);
}

}  // namespace test_sequence_source
}  // namespace rosefusion::testing
