// The files of a run.
#pragma once
#include <filesystem>

#include "host/run/reconstruction.h"

namespace rosefusion {

inline constexpr const char* kOutputFiles[] = {"trajectory.txt", "mesh.ply",      "preview.png",
                                               "frames.csv",     "settings.yaml", "report.json"};

/// The output folder of one run. Making it removes the files of an earlier run, so that what lies there after
/// a failure is never taken for this run's result. Throws InputError when the folder cannot be used.
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& folder);

  /// Writes all of kOutputFiles, report.json last: its presence says that the others are complete. Throws
  /// InputError.
  void write(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace rosefusion
