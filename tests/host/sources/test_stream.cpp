// Streams over loopback: whole through broken connections, newest first when live, with keys.
#include <atomic>
#include <cstring>
#include <random>
#include <thread>
#include <zmq.hpp>

#include "host/sources/image_codec.h"
#include "host/sources/stream.h"
#include "host/sources/wire.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/sources/cutting_proxy.h"
#include "tests/host/sources/memory_sequence.h"
#include "tests/host/sources/stream_ends.h"

namespace rosefusion::testing {
namespace test_stream {

TEST(Stream, BringsEveryFrameAndTheCamera) {
  auto frames = numberedFrames(30, 30);
  frames[3].colour = cv::Mat(kSmallCamera.height, kSmallCamera.width, CV_8UC3, cv::Scalar(1, 2, 3));
  StreamReceiver receiver(kAnyPort, {});
  Sending sending(receiver.endpoint(), frames);
  const auto received = receiveAll(receiver);
  expectAll(frames, received);
  EXPECT_EQ(receiver.info().intrinsics, kSmallCamera);
  EXPECT_EQ(receiver.info().depth_units_per_metre, 5000);
  EXPECT_EQ(receiver.info().frames, 30u);
  EXPECT_TRUE(sending.finish());
  EXPECT_EQ(sending.counts().arrived, 30u);
  EXPECT_TRUE(receiver.refusals().empty());
}

TEST(Stream, SlowReceiverHoldsTheSenderBack) {
  const auto frames = numberedFrames(40, 30);
  StreamReceiver receiver(kAnyPort, {});
  Sending sending(receiver.endpoint(), frames);
  expectAll(frames, receiveAll(receiver, 10ms));
  EXPECT_TRUE(sending.finish());
  EXPECT_EQ(sending.counts().dropped, 0u);
}

TEST(Stream, BrokenConnectionsLoseNothing) {
  std::mt19937 random(1);
  auto frames = numberedFrames(40, 30);
  for (Frame& frame : frames)  // noise, so that the messages are long and cuts fall within them
    for (int i = 0; i < kSmallCamera.width * kSmallCamera.height; ++i)
      frame.depth.at<std::uint16_t>(i) = static_cast<std::uint16_t>(random());
  StreamReceiver receiver(kAnyPort, {});
  CuttingProxy proxy(portOf(receiver.endpoint()), 30'000, 6);
  Sending sending(proxy.endpoint(), frames);
  expectAll(frames, receiveAll(receiver));
  EXPECT_TRUE(sending.finish());
  EXPECT_EQ(proxy.cutsMade(), 6);
  EXPECT_GT(sending.counts().resent, 0u);
}

TEST(Stream, LiveStreamsDropWhatTheReceiverCannotTake) {
  const auto frames = numberedFrames(60, 100);
  StreamReceiver receiver(kAnyPort, {});
  StreamOptions live;
  live.live = true;
  Sending sending(receiver.endpoint(), frames, live, 5ms);
  const auto received = receiveAll(receiver, 50ms);
  EXPECT_TRUE(sending.finish());
  EXPECT_EQ(sending.counts().arrived + sending.counts().dropped, 60u);
  ASSERT_GT(received.size(), 3u);
  EXPECT_LT(received.size(), 30u);
  std::size_t next = received.front().index;
  for (const SourceFrame& frame : received) {
    EXPECT_EQ(frame.index, next + frame.dropped * (&frame != &received.front()));
    EXPECT_TRUE(same(frame.frame.depth, frames[frame.index].depth));
    next = frame.index + 1;
  }
}

TEST(Stream, ALiveSenderWithoutAReceiverCanBeStopped) {
  const auto frames = numberedFrames(2, 30);
  StreamOptions live;
  live.live = true;
  StreamSender sender("tcp://127.0.0.1:1", infoOf(frames), live);  // where nobody listens
  EXPECT_TRUE(sender.send(frames[0], {}));
  const auto start = Clock::now();
  EXPECT_FALSE(sender.finish([&] { return Clock::now() - start < 20s; }));
  EXPECT_GT(Clock::now() - start, 2s) << "it might answer";
  EXPECT_LT(Clock::now() - start, 15s);
}

TEST(Stream, SilenceEndsAStreamWhereAsked) {
  StreamOptions options;
  options.silence_limit = 0.3;
  StreamReceiver receiver(kAnyPort, options);
  const auto frames = numberedFrames(2, 30);
  auto sender = std::make_unique<StreamSender>(receiver.endpoint(), infoOf(frames), StreamOptions{});
  std::thread waiting([&] { EXPECT_TRUE(receiver.waitForStream(after(20s))); });
  while (sender->counts().frames == 0) EXPECT_TRUE(sender->send(frames[0], after(20s)));
  sender->finish(after(1s));  // sends all, and ends unheard
  waiting.join();
  sender.reset();
  SourceFrame frame;
  while (receiver.next(frame, after(20s)) == SourceState::Frame) {
  }
}

TEST(Stream, AddressesThatCannotBeUsedAreNamed) {
  EXPECT_THAT(inputErrorOf([] { StreamReceiver("tcp://nonsense", {}); }), HasSubstr("tcp://nonsense"));
  EXPECT_THAT(inputErrorOf([] { StreamReceiver("tcp://203.0.113.1:5555", {}); }), HasSubstr("203.0.113.1"));
  EXPECT_THAT(inputErrorOf([] { StreamSender("tcp://nonsense", infoOf(numberedFrames(1, 30)), {}); }),
              HasSubstr("tcp://nonsense"));
}
// ---- Keys.

class EncryptedStream : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"server", "camera", "stranger"}) makeKeys(folder_ / name);
  }
  StreamOptions keys(const std::string& own, const std::string& other) const {
    StreamOptions options;
    options.secret_key = folder_ / (own + ".secret");
    options.peer_keys = folder_ / (other + ".public");
    return options;
  }
  TemporaryFolder folder_;
};

TEST_F(EncryptedStream, ArrivesWholeAndStrangersAreRefused) {
  const auto frames = numberedFrames(5, 30);
  StreamReceiver receiver(kAnyPort, keys("server", "camera"));
  Sending stranger(receiver.endpoint(), frames, keys("stranger", "server"));
  EXPECT_FALSE(stranger.finish());
  EXPECT_THAT(stranger.problem(), HasSubstr("does not allow this key"));
  Sending plain(receiver.endpoint(), frames);
  EXPECT_FALSE(plain.finish());
  EXPECT_THAT(plain.problem(), HasSubstr("either both ends use keys or neither"));
  EXPECT_THAT(receiver.refusals(), Contains(HasSubstr("its key is not among those allowed")));
  EXPECT_THAT(receiver.refusals(), Contains(HasSubstr("refused a connection: it ")));

  Sending camera(receiver.endpoint(), frames, keys("camera", "server"));
  expectAll(frames, receiveAll(receiver));
  EXPECT_TRUE(camera.finish());
}

TEST_F(EncryptedStream, SecretKeysAreTheUsersOwnAndNeverReplaced) {
  const auto mode = std::filesystem::status(folder_ / "server.secret").permissions();
  EXPECT_EQ(mode & (std::filesystem::perms::group_all | std::filesystem::perms::others_all),
            std::filesystem::perms::none);
  EXPECT_THAT(inputErrorOf([&] { makeKeys(folder_ / "server"); }), HasSubstr("exists already"));
}

TEST_F(EncryptedStream, UnusableKeyFilesAreNamed) {
  StreamOptions half;
  half.secret_key = folder_ / "server.secret";
  EXPECT_THAT(inputErrorOf([&] { StreamReceiver(kAnyPort, half); }), HasSubstr("--peer-key"));
  const auto bad = folder_.write("bad.public", "too short\n");
  half.peer_keys = bad;
  EXPECT_THAT(inputErrorOf([&] { StreamReceiver(kAnyPort, half); }), HasSubstr("bad.public"));
  half.peer_keys = folder_ / "missing.public";
  EXPECT_THAT(inputErrorOf([&] { StreamReceiver(kAnyPort, half); }), HasSubstr("missing.public"));
}

}  // namespace test_stream
}  // namespace rosefusion::testing
