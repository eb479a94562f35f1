#include "apps/guarded_main.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>

#include "apps/cli/exit_code.h"
#include "engine/error.h"
#include "host/core/error.h"

namespace rosefusion {

namespace {

/// Whether all that was said on standard output has arrived, as a result on a full disk does not.
int flushed() {
  std::cout.flush();
  errno = 0;
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout.good()) return kExitOk;
  spdlog::error("Standard output cannot be written{}; free some space, or write to a file elsewhere.",
                errno ? std::string(" (") + std::strerror(errno) + ")" : "");
  return kExitBadInput;
}

}  // namespace

int guardedMain(const char* name, const std::function<int()>& run) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  spdlog::set_pattern("%^%l%$: %v");
  // Else a file that grows beyond the limit of the shell (ulimit -f) ends the program without a word.
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);
#endif
  try {
    const int code = run();
    return code == kExitOk ? flushed() : code;
  } catch (const DeviceError& error) {
    spdlog::error("{}", error.what());
    return error.code() == DeviceErrorCode::Programming ? kExitFailure : kExitDevice;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kExitBadInput;
  } catch (const std::bad_alloc&) {
    spdlog::error(
        "This machine's memory is exhausted; close other programs, or make volume.voxel_size larger or "
        "depth.max "
        "smaller.");
    return kExitFailure;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kExitFailure;
  }
}

}  // namespace rosefusion
