#include "apps/cli/progress.h"

#include <algorithm>
#include <cstdio>

#include "host/core/system.h"

namespace rosefusion::cli {

Progress::Progress(std::string unit) : unit_(std::move(unit)), terminal_(isTerminal(stderr)) {}

Progress::~Progress() {
  if (drawn_) std::fputc('\n', stderr);
}

void Progress::update(std::size_t done, std::size_t total, const std::string& note) {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double rate = seconds > 0 ? done / seconds : 0;
  if (total == 0) return updateEndless(done, rate, note);
  const auto left = static_cast<long>(rate > 0 ? (total - done) / rate + 0.5 : 0);
  const char* separator = note.empty() ? "" : "  ";
  if (terminal_) {
    if (done < total && now - last_drawn_ < std::chrono::milliseconds(100)) return;
    last_drawn_ = now;
    drawn_ = true;
    constexpr std::size_t kCells = 24;
    const std::size_t filled = total ? kCells * done / total : 0;
    const std::string bar = std::string(filled, '#') + std::string(kCells - filled, '.');
    std::fprintf(stderr, "\r\033[K[%s] %zu/%zu %s  %.1f/s  ETA %ld:%02ld%s%s", bar.c_str(), done, total,
                 unit_.c_str(), rate, left / 60, left % 60, separator, note.c_str());
    std::fflush(stderr);
    return;
  }
  const std::size_t tenth = 10 * done / total;
  if (tenth == last_tenth_ && now - std::max(start_, last_drawn_) < std::chrono::minutes(1)) return;
  last_tenth_ = tenth;
  last_drawn_ = now;
  std::fprintf(stderr, "%zu/%zu %s  %.1f/s  ETA %ld:%02ld%s%s\n", done, total, unit_.c_str(), rate, left / 60,
               left % 60, separator, note.c_str());
}

void Progress::updateEndless(std::size_t done, double rate, const std::string& note) {
  const auto now = Clock::now();
  constexpr std::chrono::milliseconds kOnTerminal(100), kInLog(10000);
  if (now - last_drawn_ < (terminal_ ? kOnTerminal : kInLog)) return;
  last_drawn_ = now;
  drawn_ = terminal_;
  std::fprintf(stderr, "%s%zu %s  %.1f/s  %s%s", terminal_ ? "\r\033[K" : "", done, unit_.c_str(), rate,
               note.c_str(), terminal_ ? "" : "\n");
  std::fflush(stderr);
}

}  // namespace rosefusion::cli
