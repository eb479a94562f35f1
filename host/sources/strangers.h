// Connections of a receiver that have said nothing valid yet. ZeroMQ bounds neither how many there are, nor
// how many parts a message has, nor what is held of messages that never end; here they are kept few, short of
// words, and not for long.
#pragma once
#include <chrono>
#include <map>
#include <set>
#include <string>

namespace rosefusion::link {

/// One thread. Connections are told apart by their sockets' numbers, as ZeroMQ tells of them.
class Strangers {
 public:
  static constexpr std::size_t kMost = 64;
  static constexpr std::uint64_t kMostBytes = 1 << 20;  ///< a sender's first message is of 112
  static constexpr int kMostNonsense = 16;
  static constexpr std::chrono::seconds kLongest{10};

  /// `port`: of the receiver; no other sockets are touched.
  explicit Strangers(int port) : port_(port) {}

  void came(int connection);
  /// It has said something valid.
  void becameKnown(int connection);
  /// It has said something else, which it may do kMostNonsense times.
  void spokeNonsense(int connection);
  /// What it still says need not be read.
  bool isBrokenOff(int connection) const;
  /// Whether it was one until its end.
  bool went(int connection);
  /// Breaks off who says too much (where the system counts it: Linux) or stays too long, and the oldest of
  /// too many. The number of these.
  std::size_t breakOff();
  bool empty() const { return strangers_.empty(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Stranger {
    Clock::time_point since;
    bool too_loud = false;  ///< once more, and it goes: what it said first may not be read yet
    bool broken_off = false;
    int nonsense = 0;
  };

  void breakOff(int connection, Stranger& stranger);

  int port_;
  std::map<int, Stranger> strangers_;
  std::set<int> known_;
  Clock::time_point last_look_{};
};

}  // namespace rosefusion::link
