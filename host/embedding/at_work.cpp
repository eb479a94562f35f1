#include "host/embedding/at_work.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "host/core/system.h"

namespace rosefusion {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestWait = 10s;
/// The driver's statics come into being with its first work, and handlers run in reverse order: the last one
/// is early enough.
constexpr int kHandlers = 16;

// Without locks, which a child of fork() might find locked by a thread that it has not.
std::atomic<int> at_work{0}, handlers{0};
std::atomic<bool> ending{false};
std::atomic<std::thread::id> ending_thread;
std::atomic<std::uint64_t> counted_in{0};
thread_local int of_this_thread = 0;

/// The threads that the parent had are not here.
void forgetParents() {
  const std::uint64_t here = processNumber();
  if (counted_in.exchange(here) != here) at_work = of_this_thread;
}

void waitForWork() {
  if (ending) return;
  forgetParents();
  ending_thread = std::this_thread::get_id();
  ending = true;
  const auto last = std::chrono::steady_clock::now() + kLongestWait;
  while (at_work > of_this_thread && std::chrono::steady_clock::now() < last)
    std::this_thread::sleep_for(1ms);
}

}  // namespace

AtWork::AtWork() : AtWork(begun_) {
  while (!begun_) std::this_thread::sleep_for(1h);
}

AtWork::AtWork(bool& begun) {
  forgetParents();
  ++at_work;
  begun_ = !ending || ending_thread.load() == std::this_thread::get_id();
  begun = begun_;
  if (begun_)
    ++of_this_thread;
  else
    --at_work;
}

AtWork::~AtWork() {
  if (!begun_) return;
  --of_this_thread;
  if (handlers < kHandlers && handlers++ < kHandlers) std::atexit(waitForWork);
  --at_work;
}

}  // namespace rosefusion
