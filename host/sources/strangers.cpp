#include "host/sources/strangers.h"

#ifdef _WIN32
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#endif
#ifdef __linux__
#include <linux/tcp.h>  // netinet/tcp.h does not know of tcpi_bytes_received
#endif

#include <algorithm>
#include <cstdint>

namespace rosefusion::link {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenLooks = 10ms;
#ifdef _WIN32
constexpr int kBothWays = SD_BOTH;
#else
constexpr int kBothWays = SHUT_RDWR;
#endif

/// What a socket has received; 0 where that is not known.
std::uint64_t bytesReceived(int connection) {
#ifdef __linux__
  tcp_info info{};
  socklen_t size = sizeof info;
  if (getsockopt(connection, IPPROTO_TCP, TCP_INFO, &info, &size) == 0) return info.tcpi_bytes_received;
#endif
  (void)connection;
  return 0;
}

/// The port of this side of a connection; its number may be another file's by now.
int portOfThisSide(int connection) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(connection, reinterpret_cast<sockaddr*>(&address), &size) != 0) return -1;
  if (address.ss_family == AF_INET) return ntohs(reinterpret_cast<sockaddr_in&>(address).sin_port);
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<sockaddr_in6&>(address).sin6_port);
  return -1;
}

}  // namespace

void Strangers::came(int connection) {
  if (!known_.count(connection)) strangers_[connection] = {Clock::now()};
}

void Strangers::becameKnown(int connection) {
  known_.insert(connection);
  strangers_.erase(connection);
}

void Strangers::spokeNonsense(int connection) {
  const auto found = strangers_.find(connection);
  if (found != strangers_.end() && ++found->second.nonsense == kMostNonsense)
    breakOff(connection, found->second);
}

bool Strangers::isBrokenOff(int connection) const {
  const auto found = strangers_.find(connection);
  return found != strangers_.end() && found->second.broken_off;
}

bool Strangers::went(int connection) {
  known_.erase(connection);
  return strangers_.erase(connection) > 0;
}

/// ZeroMQ then finds it closed, and frees what it holds of it.
void Strangers::breakOff(int connection, Stranger& stranger) {
  if (portOfThisSide(connection) == port_) shutdown(connection, kBothWays);
  stranger.broken_off = true;
}

std::size_t Strangers::breakOff() {
  const auto now = Clock::now();
  if (strangers_.empty() || now - last_look_ < kBetweenLooks) return 0;
  last_look_ = now;
  std::size_t gone = 0, there = 0;
  for (auto& [connection, stranger] : strangers_) {
    if (stranger.broken_off) continue;
    const bool loud = bytesReceived(connection) > kMostBytes;
    if ((loud && stranger.too_loud) || now - stranger.since > kLongest) {
      breakOff(connection, stranger);
      ++gone;
    } else {
      stranger.too_loud = loud;
      ++there;
    }
  }
  for (; there > kMost; --there, ++gone) {
    const auto still = [](const auto& s) { return !s.second.broken_off; };
    auto oldest = std::find_if(strangers_.begin(), strangers_.end(), still);
    for (auto s = oldest; s != strangers_.end(); ++s)
      if (still(*s) && s->second.since < oldest->second.since) oldest = s;
    breakOff(oldest->first, oldest->second);
  }
  return gone;
}

}  // namespace rosefusion::link
