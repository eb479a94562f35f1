#include "apps/guarded_main.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "engine/error.h"
#include "host/core/error.h"

namespace rosefusion {

int guardedMain(const char* name, const std::function<int()>& run) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  spdlog::set_pattern("%^%l%$: %v");
  try {
    return run();
  } catch (const DeviceError& error) {
    spdlog::error("{}", error.what());
    return error.code() == DeviceErrorCode::Programming ? kExitFailure : kExitDevice;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kExitBadInput;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kExitFailure;
  }
}

}  // namespace rosefusion
