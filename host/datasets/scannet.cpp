// ScanNet (Dai et al., CVPR 2017) as its exporter unpacks it: depth/N.png in millimetres, pose/N.txt
// (camera to world, -inf where it was lost), intrinsic/intrinsic_depth.txt, color/N.jpg.
#include <cmath>

#include "host/core/error.h"
#include "host/datasets/listing.h"
#include "host/datasets/numbered_files.h"
#include "host/datasets/scannet_camera.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

fs::path findMatrix(const fs::path& folder, const std::string& of) {
  for (const fs::path& file : {folder / "intrinsic" / ("intrinsic_" + of + ".txt"),
                               folder / ("intrinsic_" + of + ".txt"), folder / "intrinsics.txt"})
    if (fs::is_regular_file(file)) return file;
  return {};
}

bool matchesScanNet(const fs::path& folder) {
  const bool described = !findMatrix(folder, "depth").empty() || fs::is_directory(folder / "pose");
  return described && hasNumberedDepth(folder / "depth");
}

Intrinsics readMatrix(const fs::path& file) {
  const auto k = intrinsicsOf(readNumbers(file));
  if (!k) throw InputError(file.string() + ": expected a camera matrix of 3x3 or 4x4 numbers, row by row.");
  return *k;
}

void readPoseFiles(Listing& listing, const std::vector<NumberedFile>& depth) {
  std::size_t damaged = 0;
  std::string first;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const fs::path file = listing.path / "pose" / (depth[i].path.stem().string() + ".txt");
    if (!fs::is_regular_file(file)) continue;
    Pose pose;
    try {
      const std::vector<double> numbers = readNumbers(file);
      if (poseFromMatrix(numbers, pose))
        listing.truth.push_back({listing.frames[i].timestamp, pose});
      else if (numbers.size() == 16 && !std::isfinite(numbers[3]))
        continue;  // the way to say that the pose is unknown
      else
        throw InputError("");
    } catch (const InputError&) {
      if (damaged++ == 0) first = file.string();
    }
  }
  if (damaged > 0)
    listing.warnings.push_back(first + ": not a finite rigid 4x4 pose; " + std::to_string(damaged) +
                               " such pose files were skipped.");
}

Listing listScanNet(const fs::path& folder) {
  Listing listing{.format = kScanNetReader.format, .path = folder, .depth_units_per_metre = 1000};
  listing.camera = kScanNetCamera;
  if (const fs::path file = findMatrix(folder, "depth"); !file.empty())
    listing.camera = {readMatrix(file), file.string(), false};
  const std::vector<NumberedFile> depth = numberedDepth(folder / "depth");
  for (const NumberedFile& file : depth) {
    listing.frames.push_back({file.number / kFramesPerSecond, file.path, {}, {}});
    for (const char* ending : {".jpg", ".png"}) {
      const fs::path colour = folder / "color" / (file.path.stem().string() + ending);
      if (listing.frames.back().colour.empty() && fs::exists(colour)) listing.frames.back().colour = colour;
    }
  }
  listing.colour_scaled = true;
  const fs::path of_colour = findMatrix(folder, "color");
  if (!of_colour.empty() && !isSameView(listing.camera.values, readMatrix(of_colour))) {
    for (FrameFiles& frame : listing.frames) frame.colour.clear();
    listing.notes.push_back("colour is of another view than depth (" + of_colour.string() + ") and left out");
  }
  listing.notes.push_back("the files have no time stamps; 30 frames per second assumed");
  readPoseFiles(listing, depth);
  return listing;
}

}  // namespace

const Reader kScanNetReader{"ScanNet folder", "depth/N.png with pose/N.txt (ScanNet)", matchesScanNet,
                            listScanNet};

}  // namespace rosefusion::datasets
