// The exception every part above the engine throws for bad input; engine failures are engine/error.h.
#pragma once
#include <stdexcept>
#include <string>

namespace rosefusion {

/// Bad input from outside (a file, a folder, a setting). what() is one sentence that names the file or the
/// setting and says what to do about it. Apps catch it once and exit with kExitBadInput.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;        ///< a defect of this program
inline constexpr int kExitBadInput = 2;       ///< InputError, or unknown command-line arguments
inline constexpr int kExitDevice = 3;         ///< no usable Vulkan device, or it failed
inline constexpr int kExitLost = 4;           ///< most frames were lost; the files written are complete
inline constexpr int kExitInterrupted = 130;  ///< Ctrl-C; the files written are complete

}  // namespace rosefusion
