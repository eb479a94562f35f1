#include "apps/cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "apps/cli/exit_code.h"

namespace rosefusion::cli {
namespace {

std::atomic<int> interruptions{0};

void onInterrupt(int) {
  if (interruptions.fetch_add(1) > 0) std::_Exit(kExitInterrupted);
}

#ifdef SIGHUP
/// The terminal is gone: what is still said to it must not end the program. Comes more than once for one
/// closed terminal, so that a second one does not hurry.
void onHangUp(int) {
  std::signal(SIGPIPE, SIG_IGN);
  interruptions.store(1);
}
#endif

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
#ifdef SIGHUP
  if (std::signal(SIGHUP, onHangUp) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
#endif
}

bool interrupted() {
  return interruptions > 0;
}

}  // namespace rosefusion::cli
