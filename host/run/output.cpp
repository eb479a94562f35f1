#include "host/run/output.h"

#include <opencv2/imgcodecs.hpp>

#include "host/error.h"
#include "host/export/mesh_io.h"
#include "host/file_io.h"
#include "host/run/mesh_extraction.h"
#include "host/run/preview.h"
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
  const Trajectory trajectory = trajectoryOf(summary);
  writeFileAtomically(folder_ / "settings.yaml", toYaml(pipeline.settings()));
  writeTumTrajectory(folder_ / "trajectory.txt", trajectory);
  writeFileAtomically(folder_ / "frames.csv", framesCsv(summary));

  const MeshSettings& mesh = pipeline.settings().mesh;
  ExtractPass extract(pipeline.device());
  writePly(folder_ / "mesh.ply",
           extractMesh(extract, pipeline.volume(),
                       {static_cast<float>(mesh.min_weight), static_cast<std::size_t>(mesh.min_component)}));
  std::vector<std::uint8_t> png;
  cv::imencode(".png", renderOverview(pipeline, trajectory), png);
  writeFileAtomically(folder_ / "preview.png", {reinterpret_cast<const char*>(png.data()), png.size()});

  writeFileAtomically(folder_ / "report.json", reportJson(summary, info, pipeline).dump(2) + "\n");
}

}  // namespace rosefusion
