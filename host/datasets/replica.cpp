// Replica as NICE-SLAM renders and stores it: results/depthNNNNNN.png, results/frameNNNNNN.jpg, traj.txt of
// row-major 4x4 camera-to-world matrices, and cam_params.json in the scene's folder or the one above it.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/text_file.h"
#include "host/datasets/listing.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

bool matchesReplica(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "results", ignored))
    if (digitsBetween(entry.path().filename().string(), "depth", ".png")) return true;
  return false;
}

void readCamera(Listing& listing) {
  listing.camera = {{1200, 680, 600.0, 600.0, 599.5, 339.5}, "the Replica (NICE-SLAM) convention", true};
  listing.depth_units_per_metre = 6553.5;
  const fs::path folder = fs::weakly_canonical(listing.path);
  for (const fs::path& file : {folder / "cam_params.json", folder.parent_path() / "cam_params.json"}) {
    if (!fs::is_regular_file(file)) continue;
    try {
      const nlohmann::json camera = nlohmann::json::parse(readTextFile(file)).at("camera");
      listing.camera = {{camera.at("w"), camera.at("h"), camera.at("fx"), camera.at("fy"), camera.at("cx"),
                         camera.at("cy")},
                        file.string(),
                        false};
      listing.depth_units_per_metre = camera.at("scale");
      listing.depth_units_assumed = false;
    } catch (const nlohmann::json::exception& error) {
      throw InputError(file.string() + ": expected {\"camera\": {w, h, fx, fy, cx, cy, scale}} (" +
                       error.what() + ").");
    }
    return;
  }
}

void readPoses(Listing& listing) {
  const fs::path file = listing.path / "traj.txt";
  if (!fs::is_regular_file(file)) return;
  std::string first;
  std::size_t skipped = 0, row_number = 0;
  for (const TextRow& row : readTextTable(file).rows) {
    std::vector<double> numbers(row.fields.size());
    bool good = true;
    for (std::size_t i = 0; i < numbers.size(); ++i) good = parseNumber(row.fields[i], numbers[i]) && good;
    Pose pose;
    if (good && poseFromMatrix(numbers, pose))
      listing.truth.push_back({static_cast<double>(row_number) / kFramesPerSecond, pose});
    else if (skipped++ == 0)
      first = "line " + std::to_string(row.line) + " is not a finite rigid 4x4 pose";
    ++row_number;
  }
  if (skipped > 0) listing.warnings.push_back(skippedLines(file, skipped, first));
}

Listing listReplica(const fs::path& folder) {
  Listing listing{.format = kReplicaReader.format, .path = folder};
  readCamera(listing);
  for (const auto& entry : fs::directory_iterator(folder / "results")) {
    const auto number = digitsBetween(entry.path().filename().string(), "depth", ".png");
    if (!number) continue;
    fs::path colour = folder / "results" / ("frame" + *number + ".jpg");
    if (!fs::exists(colour)) colour.clear();
    listing.frames.push_back({std::stoi(*number) / kFramesPerSecond, entry.path(), colour});
  }
  std::sort(listing.frames.begin(), listing.frames.end(),
            [](const FrameFiles& a, const FrameFiles& b) { return a.timestamp < b.timestamp; });
  readPoses(listing);
  return listing;
}

}  // namespace

const Reader kReplicaReader{"Replica (NICE-SLAM)", "results/depthNNNNNN.png (Replica)", matchesReplica,
                            listReplica};

}  // namespace rosefusion::datasets
