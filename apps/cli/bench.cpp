#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addBenchCommand(CLI::App&) {}

}  // namespace rosefusion::cli
