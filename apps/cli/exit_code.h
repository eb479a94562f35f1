// Ends the program with a code after everything was said and written.
#pragma once

namespace rosefusion::cli {

/// Thrown by a subcommand; main.cpp ends the program with it.
struct ExitCode {
  explicit ExitCode(int code_) : code(code_) {}
  int code;
};

}  // namespace rosefusion::cli
