// One function per subcommand: it adds the subcommand to the command line; its callback does the work and
// throws InputError / DeviceError, which main() turns into one sentence and an exit code.
#pragma once
#include <CLI/CLI.hpp>

namespace rosefusion::cli {

void addRunCommand(CLI::App& app);
void addExportCommand(CLI::App& app);
void addDevicesCommand(CLI::App& app);
void addDoctorCommand(CLI::App& app);
void addCheckCommand(CLI::App& app);
void addSynthCommand(CLI::App& app);
void addPstCommand(CLI::App& app);
void addEvalCommand(CLI::App& app);
void addEvalMeshCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addExperimentCommand(CLI::App& app);
void addRecordCommand(CLI::App& app);
void addSendCommand(CLI::App& app);
void addKeysCommand(CLI::App& app);

/// Writes `json` (already dumped text) to `file`, or to standard output when file is "-". No-op when empty.
void writeJson(const std::string& file, const std::string& json);
/// Before long work: throws InputError where writeJson would.
void requireWritableJson(const std::string& file);

}  // namespace rosefusion::cli
