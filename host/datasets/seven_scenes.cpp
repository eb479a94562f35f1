// 7-Scenes (Shotton et al., CVPR 2013): frame-NNNNNN.depth.png in millimetres with a .pose.txt each.
#include <algorithm>

#include "host/core/error.h"
#include "host/datasets/listing.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "frame-";
constexpr const char* kDepthEnding = ".depth.png";

bool matchesSevenScenes(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (digitsBetween(entry.path().filename().string(), kPrefix, kDepthEnding)) return true;
  return false;
}

CameraSource readCamera(const fs::path& folder) {
  const fs::path file = folder / "camera-intrinsics.txt";
  if (!fs::exists(file)) return {{640, 480, 585.0, 585.0, 320.0, 240.0}, "the 7-Scenes convention", true};
  const std::vector<double> k = readNumbers(file);
  if (k.size() != 9)
    throw InputError(file.string() + ": expected a 3x3 camera matrix, nine numbers row by row.");
  return {{0, 0, k[0], k[4], k[2], k[5]}, file.string(), false};
}

fs::path colourBeside(const fs::path& folder, const std::string& stem) {
  for (const char* ending : {".color.png", ".color.jpg", ".jpg"})
    if (fs::exists(folder / (stem + ending))) return folder / (stem + ending);
  return {};
}

void readPoseFiles(Listing& listing) {
  std::string first;
  std::size_t skipped = 0, missing = 0;
  for (const FrameFiles& frame : listing.frames) {
    const auto number = digitsBetween(frame.depth.filename().string(), kPrefix, kDepthEnding);
    const fs::path file = listing.path / (kPrefix + number.value() + ".pose.txt");
    Pose pose;
    if (!fs::exists(file)) {
      ++missing;
      continue;
    }
    try {
      if (poseFromMatrix(readNumbers(file), pose)) {
        listing.truth.push_back({frame.timestamp, pose});
        continue;
      }
    } catch (const InputError&) {
      // a damaged pose file is the same to the caller as one that holds no rigid transform
    }
    if (skipped++ == 0) first = file.string();
  }
  if (skipped > 0)
    listing.warnings.push_back(first + ": not a finite rigid 4x4 pose; " + std::to_string(skipped) +
                               " such pose files were skipped.");
  if (missing > 0 && !listing.truth.empty())
    listing.warnings.push_back(listing.path.string() + ": " + std::to_string(missing) +
                               " frames have no .pose.txt.");
}

Listing listSevenScenes(const fs::path& folder) {
  Listing listing{.format = kSevenScenesReader.format, .path = folder, .depth_units_per_metre = 1000};
  listing.camera = readCamera(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto number = digitsBetween(entry.path().filename().string(), kPrefix, kDepthEnding);
    if (!number) continue;
    const fs::path colour = colourBeside(folder, kPrefix + *number);
    listing.frames.push_back({std::stoi(*number) / kFramesPerSecond, entry.path(), colour});
  }
  std::sort(listing.frames.begin(), listing.frames.end(),
            [](const FrameFiles& a, const FrameFiles& b) { return a.timestamp < b.timestamp; });
  if (std::any_of(listing.frames.begin(), listing.frames.end(),
                  [](const auto& f) { return !f.colour.empty(); }))
    listing.notes.push_back(
        "7-Scenes' colour images are not registered to the depth images; colours will be offset");
  readPoseFiles(listing);
  return listing;
}

}  // namespace

const Reader kSevenScenesReader{"7-Scenes", "frame-NNNNNN.depth.png (7-Scenes)", matchesSevenScenes,
                                listSevenScenes};

}  // namespace rosefusion::datasets
