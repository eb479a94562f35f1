#include "host/sources/zmq_link.h"

#include <spdlog/spdlog.h>
#ifdef _WIN32
#include <ws2tcpip.h>
#else
#include <netdb.h>
#endif

#include <array>
#include <random>
#include <sstream>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/system.h"
#include "host/core/text_file.h"
#include "host/sources/wire.h"

namespace rosefusion {
namespace {

constexpr std::size_t kKeyText = 40;  // characters of Z85 for 32 bytes
using KeyText = std::array<char, kKeyText + 1>;

std::vector<std::string> readKeyFile(const std::filesystem::path& file) {
  std::istringstream in(readTextFile(file));
  std::vector<std::string> keys;
  std::array<std::uint8_t, 32> ignored;
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    if (line.size() != kKeyText || !zmq_z85_decode(ignored.data(), line.c_str()))
      throw InputError(file.string() +
                       ": holds no Curve key (40 characters a line); make one with 'rosefusion keys'.");
    keys.push_back(line);
  }
  if (keys.empty())
    throw InputError(file.string() + ": the key file is missing or empty; make one with 'rosefusion keys'.");
  return keys;
}

}  // namespace

bool isStreamEndpoint(const std::string& text) {
  return text.starts_with("tcp://");
}

bool streamsAvailable() {
  return true;
}

void makeKeys(const std::filesystem::path& name) {
  KeyText open{}, secret{};
  if (zmq_curve_keypair(open.data(), secret.data()) != 0)
    throw InputError("This system's ZeroMQ knows no Curve keys; install one that was built with libsodium.");
  const auto write = [&](const char* ending, const KeyText& key) {
    const std::filesystem::path file = name.string() + ending;
    if (std::filesystem::exists(file))
      throw InputError(file.string() + ": exists already, and keys are not replaced; choose another name.");
    writeFileAtomically(file, std::string(key.data()) + "\n");
  };
  {
    const PrivateFiles only_mine;
    write(".secret", secret);
  }
  write(".public", open);
}

namespace link {

Keys readKeys(const StreamOptions& options) {
  Keys keys;
  if (options.secret_key.empty() && options.peer_keys.empty()) return keys;
  if (options.secret_key.empty() || options.peer_keys.empty())
    throw InputError(
        "An encrypted stream needs both --secret-key (this side's) and --peer-key (the other side's).");
  keys.secret = readKeyFile(options.secret_key).front();
  keys.peers = readKeyFile(options.peer_keys);
  KeyText own{};
  if (zmq_curve_public(own.data(), keys.secret.c_str()) != 0)
    throw InputError(options.secret_key.string() + ": is no Curve key, or this system's ZeroMQ knows none.");
  keys.own = own.data();
  return keys;
}

std::string z85(std::span<const std::byte> key) {
  KeyText text{};
  if (key.size() != 32) return "";
  zmq_z85_encode(text.data(), reinterpret_cast<const std::uint8_t*>(key.data()), key.size());
  return text.data();
}

void requirePort(const std::string& endpoint) {
  const std::string port = endpoint.substr(endpoint.rfind(':') + 1);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == port.npos;
  if (port != "*" && !(digits && std::stoi(port) >= 1 && std::stoi(port) <= 65535))
    throw InputError(endpoint + ": its port must be 1 to 65535, such as tcp://localhost:5555.");
}

void requireKnownHost(const std::string& endpoint) {
  constexpr std::string_view kScheme = "tcp://";
  std::string host = endpoint.substr(kScheme.size(), endpoint.rfind(':') - kScheme.size());
  if (const auto source = host.find(';'); source != host.npos)
    host.erase(0, source + 1);  // ZeroMQ's SOURCE;HOST
  if (host.size() > 1 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  addrinfo* found = nullptr;
  const int problem = getaddrinfo(host.c_str(), nullptr, nullptr, &found);
  if (problem == 0) return freeaddrinfo(found);
  const std::string sentence =
      endpoint + ": the host name '" + host + "' cannot be resolved (" + gai_strerror(problem) + "); ";
  if (problem == EAI_AGAIN)
    spdlog::warn("{}trying on, as the network may come; check the name.", sentence);
  else
    throw InputError(sentence + "check it, or give the receiver's address, such as tcp://192.168.1.20:5555.");
}

void setUp(zmq::socket_t& socket) {
  // A connection that broke without a word is found out within five seconds.
  socket.set(zmq::sockopt::heartbeat_ivl, 1000);
  socket.set(zmq::sockopt::heartbeat_timeout, 5000);
  socket.set(zmq::sockopt::handshake_ivl, 5000);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::maxmsgsize, wire::kMaxMessageBytes);
  socket.set(zmq::sockopt::sndhwm, static_cast<int>(2 * kWindow));
  // Not limited: ZeroMQ (4.3.4) aborts the process where a connection whose limit is reached breaks and a
  // heartbeat is due or waits. Frames are limited by their window, and whoever says something else by
  // Strangers.
  socket.set(zmq::sockopt::rcvhwm, 0);
}

Monitor::Monitor(zmq::context_t& context, zmq::socket_t& watched, int events)
    : socket_(context, zmq::socket_type::pair) {
  static std::atomic<int> count{0};
  const std::string name = "inproc://rosefusion.monitor." + std::to_string(++count);
  if (zmq_socket_monitor(watched.handle(), name.c_str(), events) != 0)
    throw InputError(std::string("The network's connections cannot be watched (") +
                     zmq_strerror(zmq_errno()) + ").");
  socket_.set(zmq::sockopt::linger, 0);
  socket_.connect(name);
}

void Monitor::take(const std::function<void(int, std::uint32_t)>& event) {
  zmq::message_t what, where;
  while (socket_.recv(what, zmq::recv_flags::dontwait)) {
    (void)socket_.recv(where, zmq::recv_flags::none);
    if (what.size() < 6) continue;
    std::uint16_t kind;
    std::uint32_t value;
    std::memcpy(&kind, what.data(), sizeof kind);
    std::memcpy(&value, what.data<std::byte>() + sizeof kind, sizeof value);
    event(kind, value);
  }
}

void wait(std::vector<zmq::pollitem_t> items, std::chrono::milliseconds limit) {
  try {
    zmq::poll(items, limit);
  } catch (const zmq::error_t& error) {
    if (error.num() != EINTR) throw;
  }
}

}  // namespace link
}  // namespace rosefusion
