// rosefusion: the command line.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/guarded_main.h"

namespace {

int runCommandLine(int argc, char** argv) {
  CLI::App app{"rosefusion: dense 3-D reconstruction from a fast-moving depth camera, on any Vulkan device."};
  app.require_subcommand(1);
  app.set_version_flag("--version", ROSEFUSION_VERSION);
  using namespace rosefusion::cli;
  addRunCommand(app);
  addCheckCommand(app);
  addEvalCommand(app);
  addEvalMeshCommand(app);
  addExportCommand(app);
  addSynthCommand(app);
  addPstCommand(app);
  addDevicesCommand(app);
  addDoctorCommand(app);
  addBenchCommand(app);
#ifdef ROSEFUSION_EXPERIMENTS
  addExperimentCommand(app);
#endif
  addRecordCommand(app);
  addSendCommand(app);
  addKeysCommand(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 says of an unknown word only that a command is missing.
    const std::string word = argc > 1 ? argv[1] : "";
    const auto commands = app.get_subcommands([&](const CLI::App* c) { return c->get_name() == word; });
    if (!word.empty() && word[0] != '-' && commands.empty()) {
      std::fprintf(stderr, "error: there is no command '%s'%s; 'rosefusion --help' lists them.\n",
                   word.c_str(),
                   word == "experiment" ? " in this build (CMake's preset release has it)" : "");
      return rosefusion::kExitBadInput;
    }
    return app.exit(error) == 0 ? rosefusion::kExitOk : rosefusion::kExitBadInput;
  } catch (const ExitCode& exit) {
    return exit.code;
  }
  return rosefusion::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  return rosefusion::guardedMain("rosefusion", [&] { return runCommandLine(argc, argv); });
}
