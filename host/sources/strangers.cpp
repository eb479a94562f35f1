#include "host/sources/strangers.h"

#include <algorithm>

#include "host/core/system_sockets.h"

namespace rosefusion::link {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenLooks = 10ms;

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
  if (portOfThisSide(connection) == port_) shutDown(connection);
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
