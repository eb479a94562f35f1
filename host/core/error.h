// The exception every part above the engine throws for bad input; engine failures are engine/error.h.
#pragma once
#include <stdexcept>
#include <string>

namespace rosefusion {

/// Bad input from outside (a file, a folder, a setting). what() is one sentence that names the file or the
/// setting and says what to do about it. Apps catch it once.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rosefusion
