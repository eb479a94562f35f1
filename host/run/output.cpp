#include "host/run/output.h"

#include <spdlog/spdlog.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/system.h"
#include "host/export/mesh_io.h"
#include "host/export/png.h"
#include "host/run/likely_cause.h"
#include "host/run/preview.h"
#include "host/run/report.h"
#include "host/run/result.h"
#include "host/slam/mapping/mesh_extraction.h"

namespace rosefusion {
namespace {

TriangleMesh surfaceOf(ExtractPass& extract, const Volume& volume, const MeshSettings& mesh) {
  return extractMesh(extract, volume,
                     {static_cast<float>(mesh.min_weight), static_cast<std::size_t>(mesh.min_component)});
}

}  // namespace

std::string detachedFile(std::size_t map, const char* ending) {
  return "map_" + std::to_string(map) + ending;
}

OutputFolder::OutputFolder(const std::filesystem::path& folder) : folder_(folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_))
    throw InputError(folder_.string() + ": cannot be made (" + error.message() +
                     "); choose another folder with --out.");
  requireWritable(folder_ / "settings.yaml");  // now, not after an hour
}

std::string OutputFolder::resultOf() const {
  std::string bytes;
  if (readBytes(folder_ / "report.json", bytes)) return "";
  const auto report = nlohmann::json::parse(bytes, nullptr, false);
  const nlohmann::json::json_pointer key("/sequence/path");
  return report.contains(key) && report[key].is_string() ? report[key].get<std::string>() : "";
}

void OutputFolder::removeEarlier() const {
  // The report first: while it is there, it says that all the others are.
  std::vector<std::string> files(std::rbegin(kOutputFiles), std::rend(kOutputFiles));
  std::error_code unread;  // what cannot be listed cannot be removed, which the next lines find out
  for (const auto& entry : std::filesystem::directory_iterator(folder_, unread))
    if (std::regex_match(entry.path().filename().string(), std::regex("map_[0-9]+\\.(ply|txt)(\\.part)?")))
      files.push_back(entry.path().filename().string());
  for (const std::string& file : files) {
    std::error_code error;
    std::filesystem::remove(folder_ / (file + ".part"), error);  // of a run that was killed
    std::filesystem::remove(folder_ / file, error);
    if (error)
      throw InputError((folder_ / file).string() + ": cannot be replaced (" + error.message() +
                       "); choose another folder with --out.");
  }
}

void OutputFolder::writeDetachedMaps(ExtractPass& extract, Pipeline& pipeline) const {
  for (const auto& detached : pipeline.detachedMaps()) {
    const Trajectory& trajectory = detached->map.trajectory;
    if (trajectory.size() < 2) continue;  // nothing was followed
    const std::string poses = detachedFile(detached->number, ".txt");
    writeTumTrajectory(folder_ / poses, trajectory);
    const TriangleMesh surface = surfaceOf(extract, detached->map.volume, pipeline.settings().mesh);
    if (!surface.triangles.empty()) writePly(folder_ / detachedFile(detached->number, ".ply"), surface);
    spdlog::warn(
        "{} frames between {:.3f} and {:.3f} s hang together, but no frame connects them to the first map; "
        "they are a map of their own, with its poses in {}.",
        trajectory.size(), trajectory.front().timestamp, trajectory.back().timestamp, poses);
  }
}

void OutputFolder::write(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline,
                         bool page) const {
  const Trajectory trajectory = trajectoryOf(summary);
  writeFileAtomically(folder_ / "settings.yaml", toYaml(pipeline.settings()));
  writeTumTrajectory(folder_ / "trajectory.txt", trajectory);
  writeFileAtomically(folder_ / "frames.csv", framesCsv(summary));

  ExtractPass extract(pipeline.device());
  TriangleMesh surface = surfaceOf(extract, pipeline.volume(), pipeline.settings().mesh);
  if (surface.triangles.empty())
    spdlog::warn("mesh.ply is left out, for the model has no surface to show; {}",
                 lostMost(summary) ? "most frames were lost, and what was fused is too little."
                                   : "fuse more frames, or lower mesh.min_weight or mesh.min_component.");
  else
    writePly(folder_ / "mesh.ply", surface);
  writeDetachedMaps(extract, pipeline);
  writePng(folder_ / "preview.png", renderOverview(pipeline, trajectory));

  if (page)
    writeFileAtomically(
        folder_ / "view.html",
        pageOf(pageContentOf(settledPath(info.path).filename().string(), std::move(surface),
                             pageFramesOf(summary, info.seconds_per_stamp), info.intrinsics)));
  writeFileAtomically(folder_ / "report.json", reportJson(summary, info, pipeline).dump(2) + "\n");
}

}  // namespace rosefusion
