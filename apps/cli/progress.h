// Progress of long work: a bar that redraws itself on a terminal, plain lines elsewhere.
#pragma once
#include <chrono>
#include <cstddef>
#include <string>

namespace rosefusion::cli {

/// Writes to standard error. On a terminal a bar with rate and time left, elsewhere a line every tenth of the
/// work and every minute.
class Progress {
 public:
  /// `unit` in the plural, such as "frames".
  explicit Progress(std::string unit);
  ~Progress();  ///< ends the bar's line

  /// `total` 0: not known. `note`: a few words shown behind, such as the tracking status.
  void update(std::size_t done, std::size_t total, const std::string& note = "");

 private:
  void updateEndless(std::size_t done, double rate, const std::string& note);

  using Clock = std::chrono::steady_clock;
  std::string unit_;
  bool terminal_;
  bool drawn_ = false;
  std::size_t last_tenth_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_{};
};

}  // namespace rosefusion::cli
