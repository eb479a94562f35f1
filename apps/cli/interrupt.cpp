#include "apps/cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "host/core/error.h"

namespace rosefusion::cli {
namespace {

std::atomic<int> interruptions{0};

void onInterrupt(int) {
  if (interruptions.fetch_add(1) > 0) std::_Exit(kExitInterrupted);
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
}

bool interrupted() {
  return interruptions > 0;
}

}  // namespace rosefusion::cli
