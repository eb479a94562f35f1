#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addEvalCommand(CLI::App&) {}

}  // namespace rosefusion::cli
