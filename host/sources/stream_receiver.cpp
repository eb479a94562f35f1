#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "host/core/error.h"
#include "host/sources/image_codec.h"
#include "host/sources/key_check.h"
#include "host/sources/strangers.h"
#include "host/sources/wire.h"
#include "host/sources/zmq_link.h"

namespace rosefusion {
namespace {

using namespace link;
using namespace std::chrono_literals;

constexpr std::size_t kLiveFrames = 2;  // of a live camera that wait to be tracked; older ones are dropped
constexpr std::size_t kMostRefusals = 100;  // different sentences that are remembered
constexpr auto kSaySilentAfter = 5s;
constexpr auto kReceiveSlice = 50ms;  // between questions whether to stop
constexpr auto kWait = 200ms, kWaitForStrangers = 10ms;
constexpr int kMessagesAtATime = 64;  // so that connections, keys and the end are seen to in between
constexpr auto kFarewell = 1000;      // milliseconds for the last answer to leave
constexpr int kReceiverEvents = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED |
                                ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL;

}  // namespace

struct StreamReceiver::Impl {
  Keys keys;
  double silence_limit;
  std::string endpoint;
  zmq::context_t context{1};
  // The thread's own.
  zmq::socket_t socket{context, zmq::socket_type::router};
  KeyCheck key_check{context, keys};
  zmq::socket_t woken{context, zmq::socket_type::pair};
  std::unique_ptr<Monitor> monitor;
  ImageCodec codec;
  std::uint64_t session = 0;
  zmq::message_t sender;  ///< ZeroMQ's name of the connection that the stream last came through
  std::uint64_t expected = 0;
  std::uint64_t window_told = 0;
  bool ended = false;
  std::optional<Strangers> strangers;
  Clock::time_point said_ended{};
  // Shared.
  mutable std::mutex mutex;
  std::condition_variable changed;
  zmq::socket_t wake{context, zmq::socket_type::pair};
  SequenceInfo info;
  wire::Header stream;  ///< the first message's: what all of the stream share
  bool known = false, live = false, finished = false, stopping = false;
  std::deque<SourceFrame> frames;
  std::uint64_t taken = 0;   ///< sequences before it were taken by next(), or dropped
  std::uint64_t passed = 0;  ///< the sequence that would follow the last frame of next()
  Clock::time_point last_heard = Clock::now();
  bool said_silent = false;
  std::vector<std::string> refusals;
  std::string failure;
  std::thread thread;

  Impl(const std::string& own_endpoint, const StreamOptions& options)
      : keys(readKeys(options)), silence_limit(options.silence_limit) {
    requirePort(own_endpoint);
    try {
      setUp(socket);
      socket.set(zmq::sockopt::linger, kFarewell);
      key_check.listen(socket);
      monitor = std::make_unique<Monitor>(context, socket, kReceiverEvents);
      socket.bind(own_endpoint);
      endpoint = socket.get(zmq::sockopt::last_endpoint);
      strangers.emplace(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));
      woken.bind("inproc://rosefusion.wake");
      wake.connect("inproc://rosefusion.wake");
    } catch (const zmq::error_t& error) {
      throw InputError(own_endpoint + ": cannot be listened on (" + error.what() +
                       "); give an address of this machine and a free port, such as tcp://*:5555.");
    }
    thread = std::thread([this] { work(); });
  }

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
      wake.send(zmq::message_t(), zmq::send_flags::dontwait);
    }
    thread.join();
  }

  void work() {
    try {
      while (!stopRequested()) {
        link::wait({{socket.handle(), 0, ZMQ_POLLIN, 0},
                    {key_check.socket().handle(), 0, ZMQ_POLLIN, 0},
                    {monitor->socket().handle(), 0, ZMQ_POLLIN, 0},
                    {woken.handle(), 0, ZMQ_POLLIN, 0}},
                   strangers->empty() ? kWait : kWaitForStrangers);
        zmq::message_t message;
        while (woken.recv(message, zmq::recv_flags::dontwait)) {
        }
        key_check.answer([this](const std::string& sentence) { refuse(sentence); });
        monitor->take([this](int event, std::uint32_t connection) { onEvent(event, connection); });
        receive();
        if (strangers->breakOff() > 0)
          refuse("broke off a connection: it said too much or nothing for too long, or there were too many");
        if (known && windowEnd() > window_told) acknowledge();
      }
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex);
      failure = std::string("The network stream failed (") + error.what() + ").";
    }
    changed.notify_all();
  }

  bool stopRequested() const {
    const std::lock_guard lock(mutex);
    return stopping;
  }

  void refuse(const std::string& sentence) {
    const std::lock_guard lock(mutex);
    if (refusals.size() == kMostRefusals || std::count(refusals.begin(), refusals.end(), sentence)) return;
    refusals.push_back(sentence);
    spdlog::warn("{}: {}", endpoint, sentence);
  }

  /// `connection`: ZeroMQ's number of it.
  void onEvent(int event, std::uint32_t connection) {
    if (event == ZMQ_EVENT_ACCEPTED) {
      strangers->came(static_cast<int>(connection));
    } else if (event == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL) {
      refuse("refused a connection: it uses keys where this side does not, or the other way round");
    } else if (event == ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL) {
      refuse("refused a connection: it hung up before it said who it is");
    } else if (strangers->went(static_cast<int>(connection))) {
      refuse("refused a connection: it said nothing valid, speaks another protocol, or announced more than " +
             std::to_string(wire::kMaxMessageBytes >> 20) + " MiB");
    } else if (!ended &&
               Clock::now() - said_ended > kSaySilentAfter) {  // who repeats a sender may come and go
      said_ended = Clock::now();
      spdlog::info("{}: a connection ended", endpoint);
    }
  }

  void receive() {
    zmq::message_t from, part;
    for (int n = 0; n < kMessagesAtATime && socket.recv(from, zmq::recv_flags::dontwait); ++n) {
      int parts = 0;
      zmq::message_t body;
      for (bool more = from.more(); more; more = part.more()) {
        (void)socket.recv(part, zmq::recv_flags::none);
        if (parts++ == 0) body.copy(part);
      }
      const int connection = zmq_msg_get(body.handle(), ZMQ_SRCFD);
      if (strangers->isBrokenOff(connection)) continue;
      if (parts == 1)
        onMessage(from, bytesOf(body), connection);
      else
        refuse("refused a message: it has more than one part");
    }
  }

  /// `connection`: as of onEvent(), negative where ZeroMQ does not say.
  void onMessage(zmq::message_t& from, std::span<const std::byte> bytes, int connection) {
    std::string problem;
    const auto message = wire::parse(bytes, problem);
    std::uint64_t peer_session = 0;
    if (message)
      peer_session = message->header.session;
    else if (bytes.size() >= 16)
      std::memcpy(&peer_session, bytes.data() + 8, sizeof peer_session);
    if (message && !adopt(*message)) {
      if (!known) return;  // a sender that did not notice that this receiver is a new one; it will ask again
      problem = isSilent()
                    ? "another stream has begun and says nothing any more; end the receiver, or start it "
                      "with --silence-limit"
                    : "another stream is being received";
    }
    if (problem.empty() && !belongs(*message))
      problem = "its camera is not that of the stream's first message";
    if (problem.empty()) {
      if (connection >= 0) strangers->becameKnown(connection);
      sender.copy(from);
      accept(*message, problem);
    }
    if (!problem.empty()) {
      strangers->spokeNonsense(connection);
      refuse("refused a message: " + problem);
      send(from, wire::packRefusal(peer_session, problem + "."));
      return;
    }
    acknowledge();
  }

  /// The first sender who says what it has becomes the stream.
  bool adopt(const wire::Message& message) {
    const wire::Header& h = message.header;
    const std::lock_guard lock(mutex);
    if (known || message.type() != wire::Type::Probe) return known && h.session == session;
    session = h.session;
    stream = h;
    live = message.live();
    expected = taken = passed = h.sequence;
    if (expected > 0 && !live)
      spdlog::warn("{}: joined a stream at frame {}; its earlier frames went elsewhere", endpoint, expected);
    info.format = live ? "live network stream" : "network stream";
    info.path = endpoint;
    info.intrinsics = message.intrinsics();
    info.intrinsics_source = "the sender";
    info.depth_units_per_metre = h.depth_units_per_metre;
    info.seconds_per_stamp = h.seconds_per_stamp;
    info.frames = static_cast<std::size_t>(h.frames);
    known = true;
    changed.notify_all();
    return true;
  }

  bool belongs(const wire::Message& message) const {
    const wire::Header& h = message.header;
    return message.intrinsics() == info.intrinsics && h.flags == stream.flags &&
           h.depth_units_per_metre == stream.depth_units_per_metre &&
           h.seconds_per_stamp == stream.seconds_per_stamp;
  }

  void accept(const wire::Message& message, std::string& problem) {
    const std::uint64_t sequence = message.header.sequence;
    {
      const std::lock_guard lock(mutex);
      last_heard = Clock::now();
      if (std::exchange(said_silent, false)) spdlog::info("{}: the stream goes on", endpoint);
    }
    if (message.type() == wire::Type::Probe || ended) return;
    // What came already, or too early because something before it was lost, is not taken; the answer says so.
    if (live ? sequence < expected : sequence != expected) return;
    if (!live && sequence >= windowEnd()) return;
    SourceFrame frame;
    frame.index = static_cast<std::size_t>(sequence);
    if (message.type() == wire::Type::Frame) {
      const cv::Size size(info.intrinsics.width, info.intrinsics.height);
      frame.frame.timestamp = message.header.timestamp;
      if (!codec.decompressDepth(message.depth, size, frame.frame.depth) ||
          (!message.colour.empty() && !codec.decompressColour(message.colour, size, frame.frame.colour))) {
        problem = "frame " + std::to_string(sequence) + " is damaged: it cannot be decompressed";
        return;
      }
      frame.usable = true;
    }
    const std::lock_guard lock(mutex);
    expected = sequence + 1;
    ended = message.type() == wire::Type::End;
    if (frame.usable) frames.push_back(std::move(frame));
    if (live && frames.size() > kLiveFrames) frames.pop_front();
    finished = ended;
    changed.notify_all();
  }

  std::uint64_t windowEnd() const {
    const std::lock_guard lock(mutex);
    return (live ? expected : taken) + kWindow;
  }

  void acknowledge() {
    wire::Ack ack;
    ack.session = session;
    ack.expected = expected;
    ack.window_end = window_told = windowEnd();
    send(sender, wire::pack(ack));
  }

  /// Messages to a connection that is gone, or that does not read, are lost; the sender will ask again.
  void send(const zmq::message_t& to, const std::vector<std::byte>& bytes) {
    zmq::message_t address;
    address.copy(const_cast<zmq::message_t&>(to));
    if (socket.send(address, zmq::send_flags::sndmore | zmq::send_flags::dontwait))
      socket.send(zmq::buffer(bytes), zmq::send_flags::dontwait);
  }

  bool isSilent() const {
    const std::lock_guard lock(mutex);
    return Clock::now() - last_heard > kSaySilentAfter;
  }

  bool silentForTooLong() {
    const auto silence = Clock::now() - last_heard;
    if (silence_limit > 0 && silence > std::chrono::duration<double>(silence_limit)) {
      spdlog::warn("{}: silent for {} s; taken as the end of the stream", endpoint, silence_limit);
      return true;
    }
    if (silence > kSaySilentAfter && !std::exchange(said_silent, true))
      spdlog::info("{}: silent for {} s; waiting for the sender", endpoint, kSaySilentAfter.count());
    return false;
  }
};

StreamReceiver::StreamReceiver(const std::string& endpoint, const StreamOptions& options)
    : impl_(std::make_unique<Impl>(endpoint, options)) {}

StreamReceiver::~StreamReceiver() = default;

const SequenceInfo& StreamReceiver::info() const {
  return impl_->info;
}

const std::string& StreamReceiver::endpoint() const {
  return impl_->endpoint;
}

std::vector<std::string> StreamReceiver::refusals() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->refusals;
}

bool StreamReceiver::waitForStream(const StopQuestion& stop) {
  std::unique_lock lock(impl_->mutex);
  while (
      !impl_->changed.wait_for(lock, kReceiveSlice, [&] { return impl_->known || !impl_->failure.empty(); }))
    if (stop && stop()) return false;
  if (!impl_->failure.empty()) throw InputError(impl_->failure);
  return true;
}

SourceState StreamReceiver::next(SourceFrame& out, const StopQuestion& stop) {
  Impl& r = *impl_;
  std::unique_lock lock(r.mutex);
  const auto ready = [&] { return !r.frames.empty() || r.finished || !r.failure.empty(); };
  while (!r.changed.wait_for(lock, kReceiveSlice, ready)) {
    if (stop && stop()) return SourceState::Stopped;
    if (r.known && r.silentForTooLong()) return SourceState::End;
  }
  if (stop && stop()) return SourceState::Stopped;
  if (!r.failure.empty()) throw InputError(r.failure);
  if (r.frames.empty()) return SourceState::End;
  out = std::move(r.frames.front());
  r.frames.pop_front();
  out.dropped = out.index - static_cast<std::size_t>(r.passed);
  r.passed = r.taken = out.index + 1;
  r.wake.send(zmq::message_t(), zmq::send_flags::dontwait);
  return SourceState::Frame;
}

}  // namespace rosefusion
