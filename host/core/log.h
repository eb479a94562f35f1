// What is worth saying beside results and errors. Parts that others embed hand it over instead of printing
// it.
#pragma once
#include <functional>
#include <string>

namespace rosefusion {

enum class Severity { Info, Warning };

/// Takes one sentence at a time, on the thread that has something to say; empty: silence.
using Log = std::function<void(Severity, const std::string& sentence)>;

}  // namespace rosefusion
