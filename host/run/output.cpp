#include "host/run/output.h"

#include "host/error.h"
#include "host/file_io.h"
#include "host/run/report.h"

namespace rosefusion {

OutputFolder::OutputFolder(const std::filesystem::path& folder) : folder_(folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_))
    throw InputError(folder_.string() + ": cannot be made (" + error.message() +
                     "); choose another folder with --out.");
  for (const char* file : kOutputFiles) {
    fs::remove(folder_ / file, error);
    if (error)
      throw InputError((folder_ / file).string() + ": cannot be replaced (" + error.message() +
                       "); choose another folder with --out.");
  }
  writeFileAtomically(folder_ / "settings.yaml",
                      "");  // finds out now, not after an hour, that nothing can be written
  fs::remove(folder_ / "settings.yaml", error);
}

void OutputFolder::write(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline) const {
  writeFileAtomically(folder_ / "settings.yaml", toYaml(pipeline.settings()));
  writeTumTrajectory(folder_ / "trajectory.txt", trajectoryOf(summary));
  writeFileAtomically(folder_ / "frames.csv", framesCsv(summary));
  writeFileAtomically(folder_ / "report.json", reportJson(summary, info, pipeline).dump(2) + "\n");
}

}  // namespace rosefusion
