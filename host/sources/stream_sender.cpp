#include <spdlog/spdlog.h>

#include <deque>
#include <random>

#include "host/core/error.h"
#include "host/sources/image_codec.h"
#include "host/sources/wire.h"
#include "host/sources/zmq_link.h"

namespace rosefusion {
namespace {

using namespace link;
using namespace std::chrono_literals;

constexpr auto kResendAfter = 1s;  // without any answer
constexpr auto kSayWaitingAfter = 3s;
constexpr auto kLastAnswer = 10s;   // that the end arrived; the receiver may have left with it
constexpr auto kStoppedAfter = 3s;  // for the end of a live stream that was stopped, without any answer
constexpr auto kSendSlice = 20ms;   // between questions whether to stop
constexpr int kSenderEvents = ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED |
                              ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                              ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;

}  // namespace

struct StreamSender::Impl {
  struct Held {
    std::uint64_t sequence;
    std::vector<std::byte> bytes;
    bool end;
    bool sent;  ///< at least once
  };

  std::string endpoint;
  bool live;
  wire::Header header;  ///< what all messages share
  zmq::context_t context{1};
  zmq::socket_t socket{context, zmq::socket_type::dealer};
  std::unique_ptr<Monitor> monitor;
  ImageCodec codec;
  Counts counts;
  std::deque<Held> held;                   ///< not yet acknowledged, in order
  std::size_t unsent = 0;                  ///< index in `held` of the next to go out
  std::deque<std::uint64_t> on_their_way;  ///< live: sent, and not known to have arrived
  /// Live: sequences and sizes of frames not acknowledged on this connection, however long it is silent.
  std::deque<std::pair<std::uint64_t, std::size_t>> unanswered;
  std::uint64_t window_end = 0;
  std::uint64_t next_sequence = 0;
  Clock::time_point last_answer = Clock::now(), last_probe{};
  bool said_waiting = false, said_handshake = false;

  Impl(const std::string& peer_endpoint, const SequenceInfo& info, const StreamOptions& options)
      : endpoint(peer_endpoint), live(options.live) {
    const Intrinsics& k = info.intrinsics;
    std::random_device random;
    header.session = std::uint64_t(random()) << 32 | random();
    header.flags = live ? wire::kLive : 0;
    header.width = static_cast<std::uint32_t>(k.width);
    header.height = static_cast<std::uint32_t>(k.height);
    header.seconds_per_stamp = info.seconds_per_stamp;
    header.fx = k.fx;
    header.fy = k.fy;
    header.cx = k.cx;
    header.cy = k.cy;
    header.depth_units_per_metre = info.depth_units_per_metre;
    header.frames = info.frames;
    const Keys keys = readKeys(options);
    requirePort(endpoint);
    requireKnownHost(endpoint);
    try {
      setUp(socket);
      socket.set(zmq::sockopt::immediate, true);  // nothing is queued for a connection that is not there
      socket.set(zmq::sockopt::reconnect_ivl, 100);
      socket.set(zmq::sockopt::reconnect_ivl_max, 2000);
      if (keys) {
        socket.set(zmq::sockopt::curve_serverkey, keys.peers.front());
        socket.set(zmq::sockopt::curve_publickey, keys.own);
        socket.set(zmq::sockopt::curve_secretkey, keys.secret);
      }
      monitor = std::make_unique<Monitor>(context, socket, kSenderEvents);
      socket.connect(endpoint);
    } catch (const zmq::error_t& error) {
      throw InputError(endpoint + ": cannot be connected to (" + error.what() +
                       "); give the receiver's address, such as tcp://192.168.1.20:5555.");
    }
  }

  bool put(const std::vector<std::byte>& bytes) {
    return socket.send(zmq::buffer(bytes), zmq::send_flags::dontwait).has_value();
  }

  void probe() {
    wire::Header h = header;
    h.type = static_cast<std::uint16_t>(wire::Type::Probe);
    h.sequence = held.empty() ? next_sequence : held.front().sequence;
    put(wire::pack(h));
  }

  /// Begins again with the oldest frame that was not acknowledged, as after a new connection.
  void goBack() {
    unsent = 0;
    on_their_way.clear();
    unanswered.clear();  // lost with the old connection, as far as is known
    last_answer = Clock::now();
    probe();
  }

  void onEvent(int event) {
    if (event == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) return goBack();
    if (event == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH)
      throw InputError(endpoint +
                       ": the receiver does not allow this key; add it to the receiver's --peer-key file.");
    if (event == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL)
      throw InputError(
          endpoint +
          ": no agreement on how to talk; either both ends use keys or neither, and the receiver's "
          "address must be that of 'rosefusion run'.");
    if (event == ZMQ_EVENT_DISCONNECTED)
      spdlog::warn("{}: the connection broke; trying again", endpoint);
    else if (!std::exchange(said_handshake, true))
      spdlog::warn("{}: the other end hung up at once; are the keys right? trying again", endpoint);
  }

  void countArrived(std::size_t bytes) {
    ++counts.arrived;
    counts.arrived_bytes += bytes;
  }

  void takeAnswers() {
    monitor->take([this](int event, std::uint32_t) { onEvent(event); });
    zmq::message_t message;
    while (socket.recv(message, zmq::recv_flags::dontwait)) {
      const wire::Answer answer = wire::parseAnswer(bytesOf(message), header.session);
      if (!answer.refusal.empty())
        throw InputError(endpoint + ": the receiver refuses the stream: " + answer.refusal);
      if (!answer.ack) continue;
      last_answer = Clock::now();
      said_waiting = false;
      window_end = answer.ack->window_end;
      while (!held.empty() && held.front().sequence < answer.ack->expected) {
        if (!held.front().end) countArrived(held.front().bytes.size());
        held.pop_front();
        if (unsent > 0) --unsent;
      }
      for (; !unanswered.empty() && unanswered.front().first < answer.ack->expected; unanswered.pop_front())
        countArrived(unanswered.front().second);
      std::erase_if(on_their_way, [&](std::uint64_t sequence) { return sequence < answer.ack->expected; });
    }
  }

  bool mayGo(const Held& message) const {
    return live ? window_end > 0 && on_their_way.size() < kWindow : message.sequence < window_end;
  }

  void sendWhatMayGo() {
    while (unsent < held.size() && mayGo(held[unsent])) {
      Held& next = held[unsent];
      if (!put(next.bytes)) return;
      counts.resent += next.sent;
      next.sent = true;
      if (live) on_their_way.push_back(next.sequence);
      if (live && !next.end) {
        unanswered.emplace_back(next.sequence, next.bytes.size());
        held.erase(held.begin() + static_cast<std::ptrdiff_t>(unsent));
      } else {
        ++unsent;
      }
    }
  }

  void pump(std::chrono::milliseconds limit) {
    if (limit > 0ms)
      link::wait({{socket.handle(), 0, ZMQ_POLLIN, 0}, {monitor->socket().handle(), 0, ZMQ_POLLIN, 0}},
                 limit);
    takeAnswers();
    sendWhatMayGo();
    if (held.empty()) return;
    const auto silence = Clock::now() - last_answer;
    if (silence > kSayWaitingAfter && !std::exchange(said_waiting, true))
      spdlog::info("waiting for a receiver at {}", endpoint);
    if (silence > kResendAfter && Clock::now() - last_probe > kResendAfter) {
      last_probe = Clock::now();
      unsent = 0;
      on_their_way.clear();
      probe();
    }
  }
  std::vector<std::byte> compressed(const Frame& frame) {
    const auto start = Clock::now();
    wire::Header h = header;
    h.type = static_cast<std::uint16_t>(wire::Type::Frame);
    h.sequence = next_sequence;
    h.timestamp = frame.timestamp;
    const auto depth_bytes = codec.compressDepth(frame.depth);
    const std::vector<std::byte> depth(depth_bytes.begin(), depth_bytes.end());
    std::vector<std::byte> message = wire::pack(
        h, depth, frame.colour.empty() ? std::span<const std::byte>{} : codec.compressColour(frame.colour));
    ++counts.frames;
    counts.raw_bytes += 2 * frame.depth.total() + 3 * frame.colour.total();
    counts.sent_bytes += message.size();
    counts.compress_seconds += std::chrono::duration<double>(Clock::now() - start).count();
    return message;
  }
};

StreamSender::StreamSender(const std::string& endpoint, const SequenceInfo& info,
                           const StreamOptions& options)
    : impl_(std::make_unique<Impl>(endpoint, info, options)) {}

StreamSender::~StreamSender() = default;

const StreamSender::Counts& StreamSender::counts() const {
  return impl_->counts;
}

bool StreamSender::send(const Frame& frame, const StopQuestion& stop) {
  Impl& s = *impl_;
  if (s.live && !s.held.empty()) {
    s.counts.dropped += s.held.size();
    s.held.clear();
    s.unsent = 0;
  }
  s.held.push_back({s.next_sequence, s.compressed(frame), false, false});
  ++s.next_sequence;
  s.pump(0ms);
  while (!s.live && s.held.size() > kWindow) {
    if (stop && stop()) return false;
    s.pump(kSendSlice);
  }
  return true;
}

bool StreamSender::finish(const StopQuestion& stop) {
  Impl& s = *impl_;
  wire::Header end = s.header;
  end.type = static_cast<std::uint16_t>(wire::Type::End);
  end.sequence = s.next_sequence;
  s.held.push_back({s.next_sequence++, wire::pack(end), true, false});
  while (!s.held.empty()) {
    if (stop && stop() && (!s.live || Clock::now() - s.last_answer > kStoppedAfter)) return false;
    s.pump(kSendSlice);
    if (!s.held.empty() && s.held.front().end && s.held.front().sent &&
        Clock::now() - s.last_answer > kLastAnswer) {
      spdlog::warn("{}: all frames arrived, but the receiver did not confirm the end", s.endpoint);
      break;
    }
  }
  return true;
}

}  // namespace rosefusion
