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

}  // namespace rosefusion::cli
