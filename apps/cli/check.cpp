#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addCheckCommand(CLI::App&) {}

}  // namespace rosefusion::cli
