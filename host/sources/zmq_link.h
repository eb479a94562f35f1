// What sender and receiver have in common of ZeroMQ; included by them only.
#pragma once
#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "host/sources/stream.h"

namespace rosefusion::link {

using Clock = std::chrono::steady_clock;
inline constexpr std::uint64_t kWindow = 8;  ///< frames on their way or waiting to be tracked

struct Keys {
  std::string secret, own;         ///< Z85 text; empty: no encryption
  std::vector<std::string> peers;  ///< public keys
  explicit operator bool() const { return !secret.empty(); }
};
/// Throws InputError for one file without the other, or for unreadable ones.
Keys readKeys(const StreamOptions& options);
/// Public key as text of its 32 bytes.
std::string z85(std::span<const std::byte> key);

/// Throws InputError unless the endpoint ends in a port, which ZeroMQ would cut to 16 bits without a word.
void requirePort(const std::string& endpoint);
/// Throws InputError where the host of tcp://HOST:PORT is not known; says so where it cannot be asked for
/// now.
void requireKnownHost(const std::string& endpoint);

/// Options of both ends: limits, heartbeats, no lingering.
void setUp(zmq::socket_t& socket);

inline std::span<const std::byte> bytesOf(const zmq::message_t& message) {
  return {message.data<std::byte>(), message.size()};
}

/// What ZeroMQ tells about a socket's connections.
class Monitor {
 public:
  Monitor(zmq::context_t& context, zmq::socket_t& watched, int events);
  zmq::socket_t& socket() { return socket_; }
  /// Calls `event` with each of ZMQ_EVENT_* that happened, and its value.
  void take(const std::function<void(int, std::uint32_t)>& event);

 private:
  zmq::socket_t socket_;
};

/// Sleeps until one of them can be read; signals end it early.
void wait(std::vector<zmq::pollitem_t> items, std::chrono::milliseconds limit);

}  // namespace rosefusion::link
