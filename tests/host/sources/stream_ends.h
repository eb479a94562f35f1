// Both ends of a stream, for its tests.
#pragma once
#include <chrono>
#include <thread>

#include "host/sources/stream.h"
#include "tests/host/sources/memory_sequence.h"

namespace rosefusion::testing {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

inline constexpr const char* kAnyPort = "tcp://127.0.0.1:*";

/// Ends a test that hangs.
inline StopQuestion after(std::chrono::seconds limit) {
  return [end = Clock::now() + limit] { return Clock::now() > end; };
}

inline SequenceInfo infoOf(const std::vector<Frame>& frames) {
  return MemorySequence(frames, kSmallCamera).info();
}

/// Sends on a thread of its own; what goes wrong there is said by finish().
class Sending {
 public:
  Sending(const std::string& endpoint, const std::vector<Frame>& frames, const StreamOptions& options = {},
          std::chrono::milliseconds pause = 0ms) {
    thread_ = std::thread([=, this] {
      try {
        StreamSender sender(endpoint, infoOf(frames), options);
        const StopQuestion stop = after(20s);
        for (const Frame& frame : frames) {
          if (!sender.send(frame, stop)) break;
          std::this_thread::sleep_for(pause);
        }
        whole_ = sender.finish(stop);
        counts_ = sender.counts();
      } catch (const InputError& error) {
        problem_ = error.what();
      }
    });
  }
  ~Sending() {
    if (thread_.joinable()) thread_.join();
  }
  bool finish() {
    thread_.join();
    return whole_;
  }
  const std::string& problem() const { return problem_; }
  const StreamSender::Counts& counts() const { return counts_; }

 private:
  bool whole_ = false;
  std::string problem_;
  StreamSender::Counts counts_;
  std::thread thread_;
};

inline std::vector<SourceFrame> receiveAll(StreamReceiver& receiver, std::chrono::milliseconds pause = 0ms) {
  const StopQuestion stop = after(20s);
  std::vector<SourceFrame> out;
  EXPECT_TRUE(receiver.waitForStream(stop));
  SourceFrame frame;
  SourceState state = SourceState::Stopped;
  while ((state = receiver.next(frame, stop)) == SourceState::Frame) {
    out.push_back(frame);
    std::this_thread::sleep_for(pause);
  }
  EXPECT_EQ(state, SourceState::End);
  return out;
}

inline void expectAll(const std::vector<Frame>& sent, const std::vector<SourceFrame>& received) {
  ASSERT_EQ(received.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(received[i].index, i);
    EXPECT_EQ(received[i].dropped, 0u);
    EXPECT_EQ(received[i].frame.timestamp, sent[i].timestamp);
    EXPECT_TRUE(same(received[i].frame.depth, sent[i].depth)) << i;
    EXPECT_TRUE(sent[i].colour.empty() ? received[i].frame.colour.empty()
                                       : same(received[i].frame.colour, sent[i].colour));
  }
}

}  // namespace rosefusion::testing
