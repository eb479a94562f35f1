#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addRunCommand(CLI::App&) {}

}  // namespace rosefusion::cli
