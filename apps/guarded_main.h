// What every program here does around its work: where its log goes, and which exit code an exception becomes.
#pragma once
#include <functional>

namespace rosefusion {

/// Returns what `run` returns, or the exit code (apps/cli/exit_code.h) of what it threw, after saying that on
/// standard error. `name`: of the logger.
int guardedMain(const char* name, const std::function<int()>& run);

}  // namespace rosefusion
