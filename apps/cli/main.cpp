// rosefusion: the command line. Errors from every subcommand are caught here, once.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "engine/error.h"
#include "host/error.h"

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
  addSynthCommand(app);
  addPstCommand(app);
  addDevicesCommand(app);
  addBenchCommand(app);
#ifdef ROSEFUSION_EXPERIMENTS
  addExperimentCommand(app);
#endif
  addSendCommand(app);
  addKeysCommand(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? rosefusion::kExitOk : rosefusion::kExitBadInput;
  }
  return rosefusion::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("rosefusion"));
  spdlog::set_pattern("%^%l%$: %v");
  try {
    return runCommandLine(argc, argv);
  } catch (const rosefusion::cli::ExitCode& exit) {
    return exit.code;
  } catch (const rosefusion::DeviceError& error) {
    spdlog::error("{}", error.what());
    return error.code() == rosefusion::DeviceErrorCode::Programming ? rosefusion::kExitFailure
                                                                    : rosefusion::kExitDevice;
  } catch (const rosefusion::InputError& error) {
    spdlog::error("{}", error.what());
    return rosefusion::kExitBadInput;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return rosefusion::kExitFailure;
  }
}
