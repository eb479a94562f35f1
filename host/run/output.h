// The files of a run.
#pragma once
#include <filesystem>

#include "host/run/reconstruction.h"

namespace rosefusion {

class ExtractPass;

inline constexpr const char* kOutputFiles[] = {"trajectory.txt", "mesh.ply",  "preview.png", "frames.csv",
                                               "settings.yaml",  "view.html", "report.json"};

/// Of a map that no frame connected to the first.
std::string detachedFile(std::size_t map, const char* ending);

/// The output folder of one run.
class OutputFolder {
 public:
  /// Makes it and finds out whether it can be written to. Throws InputError when it cannot be used.
  explicit OutputFolder(const std::filesystem::path& folder);

  /// The recording whose result lies there (`sequence.path` of its report); empty: none, or not told.
  std::string resultOf() const;
  /// Removes the files of an earlier run, so that what lies there after a failure is never taken for this
  /// run's result: once the frames are about to come, since a mistyped setting must not cost a result.
  void removeEarlier() const;
  /// Writes all of kOutputFiles and the maps that are not connected to the first, report.json last: its
  /// presence says that the others are complete. Without a triangle there is no mesh.ply, with a warning.
  /// `page`: view.html too. Throws InputError.
  void write(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline, bool page = true) const;

 private:
  /// Mesh and trajectory of each, as map_2.ply and map_2.txt, with a warning that says so.
  void writeDetachedMaps(ExtractPass& extract, Pipeline& pipeline) const;

  std::filesystem::path folder_;
};

}  // namespace rosefusion
