#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addDevicesCommand(CLI::App&) {}

}  // namespace rosefusion::cli
