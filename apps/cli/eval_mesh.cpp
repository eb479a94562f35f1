#include "apps/cli/commands.h"

namespace rosefusion::cli {

void addEvalMeshCommand(CLI::App&) {}

}  // namespace rosefusion::cli
