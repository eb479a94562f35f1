#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addPstCommand(CLI::App&) {}

}  // namespace rosefusion::cli
