// A Log for programs, which have an spdlog logger of their own.
#pragma once
#include <spdlog/spdlog.h>

#include "host/core/log.h"

namespace rosefusion {

inline void logToSpdlog(Severity severity, const std::string& sentence) {
  spdlog::log(severity == Severity::Warning ? spdlog::level::warn : spdlog::level::info, "{}", sentence);
}

}  // namespace rosefusion
