// What does not belong to a stream. Each test ends with a stream that arrives whole.
#include <atomic>
#include <cstring>
#include <random>
#include <set>
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
namespace test_hostile_stream {

class HostileStream : public ::testing::Test {
 protected:
  StreamReceiver receiver_{kAnyPort, {}};
  zmq::context_t context_;

  void sendRaw(const std::vector<std::byte>& bytes) { sendParts({bytes}); }
  void sendParts(const std::vector<std::vector<std::byte>>& parts) {
    zmq::socket_t socket(context_, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::linger, 2000);
    socket.connect(receiver_.endpoint());
    for (std::size_t i = 0; i < parts.size(); ++i)
      socket.send(zmq::buffer(parts[i]),
                  i + 1 < parts.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
  /// Waits until the receiver has said it.
  void expectRefusal(const std::string& part) {
    for (const auto stop = after(10s); !stop(); std::this_thread::sleep_for(5ms))
      for (const std::string& sentence : receiver_.refusals())
        if (sentence.find(part) != std::string::npos) return;
    ADD_FAILURE() << "not refused: " << part << "; refused were "
                  << ::testing::PrintToString(receiver_.refusals());
  }
  void expectThatAStreamStillArrives() {
    const auto frames = numberedFrames(5, 30);
    Sending sending(receiver_.endpoint(), frames);
    expectAll(frames, receiveAll(receiver_));
    EXPECT_TRUE(sending.finish());
  }
  /// A connection as of a ZeroMQ peer; closed by the caller. `greeted`: whether it was answered, which it has
  /// to be where that is not asked.
  int connectAsPeer(bool* greeted = nullptr) const {
    const int s = connectTo(portOf(receiver_.endpoint()));
    const timeval limit{10, 0};
    setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    setsockopt(s, SOL_SOCKET, SO_SNDTIMEO, &limit,
               sizeof limit);  // a system short of memory may lose a reset
    std::string greeting("\xff\0\0\0\0\0\0\0\1\x7f\3\0NULL", 16);
    greeting.resize(64, '\0');
    const std::string said = greeting + std::string("\4\x1c\5READY\x0bSocket-Type\0\0\0\6DEALER", 30);
    EXPECT_EQ(::send(s, said.data(), said.size(), MSG_NOSIGNAL), static_cast<ssize_t>(said.size()));
    char answer[107];  // messages that come before it are none
    const bool whole = recv(s, answer, sizeof answer, MSG_WAITALL) == static_cast<ssize_t>(sizeof answer);
    EXPECT_TRUE(whole || greeted);
    if (greeted) *greeted = whole;
    return s;
  }
  static wire::Header header(wire::Type type) {
    wire::Header h;
    h.type = static_cast<std::uint16_t>(type);
    h.session = 99;
    h.width = static_cast<std::uint32_t>(kSmallCamera.width);
    h.height = static_cast<std::uint32_t>(kSmallCamera.height);
    h.fx = kSmallCamera.fx;
    h.fy = kSmallCamera.fy;
    h.cx = kSmallCamera.cx;
    h.cy = kSmallCamera.cy;
    h.depth_units_per_metre = 5000;
    return h;
  }
};

TEST_F(HostileStream, GarbageIsRefused) {
  std::mt19937 random(2);
  for (const std::size_t length : {0u, 1u, 15u, 100u, 5000u}) {
    std::vector<std::byte> bytes(length);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    sendRaw(bytes);
  }
  expectRefusal("none of rosefusion's");
  sendParts({std::vector<std::byte>(3), std::vector<std::byte>(3)});
  expectRefusal("more than one part");
  expectThatAStreamStillArrives();
}

TEST_F(HostileStream, BytesOfAnotherProtocolAreRefused) {
  const int s = connectTo(portOf(receiver_.endpoint()));
  const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" + std::string(200, '\xff');
  ASSERT_GT(::send(s, request.data(), request.size(), MSG_NOSIGNAL), 0);
  expectRefusal("speaks another protocol");
  close(s);
  expectThatAStreamStillArrives();
}

TEST_F(HostileStream, TruncatedAndOutdatedMessagesAreRefused) {
  auto bytes = wire::pack(header(wire::Type::Frame), std::vector<std::byte>(50));
  bytes.resize(bytes.size() - 20);
  sendRaw(bytes);
  expectRefusal("do not add up");
  sendRaw({bytes.begin(), bytes.begin() + 60});
  expectRefusal("truncated");
  wire::Header h = header(wire::Type::Probe);
  h.version = 2;
  sendRaw(wire::pack(h));
  expectRefusal("version is 2");
  expectThatAStreamStillArrives();
}

TEST_F(HostileStream, HugeSizesAreRefusedUnread) {
  wire::Header h = header(wire::Type::Probe);
  h.width = h.height = 0x7FFFFFFF;
  sendRaw(wire::pack(h));
  expectRefusal("2147483647x2147483647");
  // A ZeroMQ peer that announces a message of 2^60 bytes is cut off before any of it is read.
  const int s = connectAsPeer();
  const std::string announced("\2\x10\0\0\0\0\0\0\0", 9);
  ASSERT_EQ(::send(s, announced.data(), announced.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(announced.size()));
  char reply[256];
  ssize_t n = 0;
  while ((n = recv(s, reply, sizeof reply, 0)) > 0) {
  }
  EXPECT_TRUE(n == 0 || errno == ECONNRESET) << "still connected after ten seconds";
  close(s);
  expectRefusal("more than 64 MiB");
  expectThatAStreamStillArrives();
}

#ifdef __linux__  // other systems do not count what a connection has received
TEST_F(HostileStream, AMessageThatNeverEndsIsBrokenOff) {
  const int s = connectAsPeer();
  std::string part("\3\0\0\0\0\0\1\0\0", 9);  // 64 KiB, and more to come
  part.resize(part.size() + 0x10000);
  constexpr int kParts = 16 * 1024;  // 1 GiB
  int said = 0;
  while (said<kParts&& ::send(s, part.data(), part.size(), MSG_NOSIGNAL)> 0) ++said;
  EXPECT_LT(said, kParts);
  close(s);
  expectRefusal("said too much");
  expectThatAStreamStillArrives();
}
#endif

TEST_F(HostileStream, SurvivesAFloodThatBreaksOff) {
  wire::Header large = header(wire::Type::Probe);
  large.width = large.height = wire::kMaxSide;
  large.fx = large.fy = large.cx = large.cy = wire::kMaxSide / 2;
  sendRaw(wire::pack(large));
  ASSERT_TRUE(receiver_.waitForStream(after(20s)));
  std::thread keeping_it_busy([&] {  // damaged where it is seen late
    large.type = static_cast<std::uint16_t>(wire::Type::Frame);
    ImageCodec codec;
    const auto bytes = wire::pack(
        large, codec.compressDepth(cv::Mat(wire::kMaxSide, wire::kMaxSide, CV_16UC1, cv::Scalar(1))),
        std::vector<std::byte>(50));
    for (int i = 0; i < 20; ++i) sendRaw(bytes);
  });
  std::string said;
  for (int i = 0; i < 2000; ++i) said += std::string("\0\3abc\4\7\4PING\0\0", 14);
  // One that takes the number of a socket that just went may be taken for it, and broken off.
  int greeted = 0;
  for (int n = 0; n < 100; ++n) {
    bool answered = false;
    const int s = connectAsPeer(&answered);
    greeted += answered ? 1 : 0;
    const linger reset{1, 0};
    setsockopt(s, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    (void)!::send(s, said.data(), said.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    std::this_thread::sleep_for(10ms);
    close(s);
  }
  keeping_it_busy.join();
  EXPECT_GE(greeted, 50);
  expectRefusal("damaged");
  expectRefusal("none of rosefusion's");
}

TEST_F(HostileStream, OnlySomeSilentConnectionsAreKept) {
  std::vector<int> silent(200);
  for (int& s : silent) ASSERT_GE(s = connectTo(portOf(receiver_.endpoint())), 0);
  expectRefusal("there were too many");
  expectThatAStreamStillArrives();
  // Those that the receiver's queue had no room for are accepted a second later. All leave after ten.
  std::set<int> ended;
  for (const auto stop = after(8s); ended.size() < 100 && !stop(); std::this_thread::sleep_for(5ms))
    for (const int s : silent) {
      char byte[64];
      ssize_t n = 0;
      while ((n = recv(s, byte, sizeof byte, MSG_DONTWAIT)) > 0) {
      }
      if (n == 0 || errno != EAGAIN) ended.insert(s);
    }
  for (const int s : silent) close(s);
  EXPECT_GE(ended.size(), 100) << "of 200, of which 64 may stay";
}

TEST_F(HostileStream, AFloodHoldsUpNeitherTheStreamNorTheEnd) {
  auto receiver = std::make_unique<StreamReceiver>(kAnyPort, StreamOptions{});
  std::atomic<bool> enough = false;
  std::vector<std::thread> flood;
  for (int n = 0; n < 3; ++n)
    flood.emplace_back([&, endpoint = receiver->endpoint()] {
      zmq::socket_t socket(context_, zmq::socket_type::dealer);
      socket.set(zmq::sockopt::linger, 0);
      socket.connect(endpoint);
      const auto message = wire::pack(header(wire::Type::End));
      while (!enough) socket.send(zmq::buffer(message), zmq::send_flags::dontwait);
    });
  const auto frames = numberedFrames(5, 30);
  Sending sending(receiver->endpoint(), frames);
  expectAll(frames, receiveAll(*receiver));
  EXPECT_TRUE(sending.finish());
  const auto start = Clock::now();
  receiver.reset();
  EXPECT_LT(Clock::now() - start, 10s);
  enough = true;
  for (std::thread& thread : flood) thread.join();
}

TEST_F(HostileStream, DamagedAndForeignFramesStayOut) {
  const auto frames = numberedFrames(5, 30);
  StreamSender sender(receiver_.endpoint(), infoOf(frames), {});
  ASSERT_TRUE(sender.send(frames[0], after(20s)));
  std::thread finishing;
  SourceFrame frame;
  std::thread pumping([&] {
    for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_TRUE(sender.send(frames[i], after(20s)));
    EXPECT_TRUE(sender.finish(after(20s)));
  });
  ASSERT_TRUE(receiver_.waitForStream(after(20s)));
  ImageCodec codec;
  sendRaw(wire::pack(header(wire::Type::Frame), codec.compressDepth(frames[4].depth)));
  expectRefusal("another stream is being received");
  std::vector<SourceFrame> received;
  while (receiver_.next(frame, after(20s)) == SourceState::Frame) received.push_back(frame);
  pumping.join();
  expectAll(frames, received);
}

TEST_F(HostileStream, ADamagedFrameIsRefusedWithAReason) {
  sendRaw(wire::pack(header(wire::Type::Probe)));
  ASSERT_TRUE(receiver_.waitForStream(after(20s)));
  sendRaw(wire::pack(header(wire::Type::Frame), std::vector<std::byte>(500, std::byte{7})));
  expectRefusal("damaged");
  wire::Header other = header(wire::Type::Probe);
  other.fx *= 2;
  sendRaw(wire::pack(other));
  expectRefusal("its camera is not that");
  ImageCodec codec;
  const auto frames = numberedFrames(1, 30);
  sendRaw(wire::pack(header(wire::Type::Frame), codec.compressDepth(frames[0].depth)));
  SourceFrame frame;
  ASSERT_EQ(receiver_.next(frame, after(20s)), SourceState::Frame);
  EXPECT_TRUE(same(frame.frame.depth, frames[0].depth));
}

TEST_F(HostileStream, AFrameBeforeTheStreamHasBegunIsLetPass) {
  ImageCodec codec;
  sendRaw(wire::pack(header(wire::Type::Frame), codec.compressDepth(numberedFrames(1, 30)[0].depth)));
  sendRaw(std::vector<std::byte>(100));
  expectRefusal("none of rosefusion's");
  EXPECT_THAT(receiver_.refusals(), ::testing::Not(Contains(HasSubstr("another stream"))))
      << "as after a restart of the receiver, which the sender has not noticed";
  expectThatAStreamStillArrives();
}

TEST_F(HostileStream, ASecondSenderIsToldThatThereIsOne) {
  const auto frames = numberedFrames(3, 30);
  StreamSender first(receiver_.endpoint(), infoOf(frames), {});
  std::atomic<bool> begun = false;
  std::thread waiting([&] {
    EXPECT_TRUE(receiver_.waitForStream(after(20s)));
    begun = true;
  });
  // A send that is refused in between has filled what nobody reads yet.
  while (!begun) first.send(frames[0], after(1s));
  waiting.join();
  Sending second(receiver_.endpoint(), frames);
  EXPECT_FALSE(second.finish());
  EXPECT_THAT(second.problem(), HasSubstr("another stream is being received"));
}

}  // namespace test_hostile_stream
}  // namespace rosefusion::testing
