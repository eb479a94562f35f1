#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addSynthCommand(CLI::App&) {}

}  // namespace rosefusion::cli
