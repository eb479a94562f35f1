#include <iostream>

#include "apps/cli/commands.h"
#include "host/core/file_io.h"

namespace rosefusion::cli {

void writeJson(const std::string& file, const std::string& json) {
  if (file == "-")
    std::cout << json << '\n';
  else if (!file.empty())
    writeFileAtomically(file, json + "\n");
}

void requireWritableJson(const std::string& file) {
  if (!file.empty() && file != "-") requireWritable(file);
}

}  // namespace rosefusion::cli
