// What options accept beyond CLI11's own checks.
#pragma once
#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace rosefusion::cli {

/// Finite numbers above 0. CLI11's PositiveNumber names its largest one, with 309 digits.
inline CLI::Validator positive() {
  return {[](std::string& text) {
            double value = 0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return good ? std::string() : "'" + text + "' is not a number above 0";
          },
          "POSITIVE"};
}

}  // namespace rosefusion::cli
