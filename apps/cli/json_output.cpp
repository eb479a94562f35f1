#include <cmath>
#include <iostream>

#include "apps/cli/commands.h"
#include "host/file_io.h"

namespace rosefusion::cli {

void writeJson(const std::string& file, const std::string& json) {
  if (file == "-")
    std::cout << json << '\n';
  else if (!file.empty())
    writeFileAtomically(file, json + "\n");
}

CLI::Validator positive() {
  return {[](std::string& text) {
            double value = 0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return good ? std::string() : "'" + text + "' is not a number above 0";
          },
          "POSITIVE"};
}

void requireWritableJson(const std::string& file) {
  if (!file.empty() && file != "-") requireWritable(file);
}

}  // namespace rosefusion::cli
