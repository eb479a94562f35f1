// What the programs here exit with.
#pragma once

namespace rosefusion {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;  ///< a defect of this program
inline constexpr int kExitBadInput =
    2;                                 ///< InputError (host/core/error.h), or unknown command-line arguments
inline constexpr int kExitDevice = 3;  ///< no usable Vulkan device, or it failed
inline constexpr int kExitLost = 4;    ///< most frames were lost; the files written are complete
inline constexpr int kExitInterrupted = 130;  ///< Ctrl-C; the files written are complete

namespace cli {

/// Thrown by a subcommand after everything was said and written; main.cpp ends the program with it.
struct ExitCode {
  explicit ExitCode(int exit_code) : code(exit_code) {}
  int code;
};

}  // namespace cli
}  // namespace rosefusion
