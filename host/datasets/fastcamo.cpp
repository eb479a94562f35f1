// FastCaMo as a folder (Zhang et al., TOG 2021): associations.txt with the colour image first; depth in
// millimetres.
#include "host/core/error.h"
#include "host/datasets/association.h"
#include "host/datasets/listing.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

/// TUM folders have the same associations, but also depth.txt, a calibration, or a name that gives them away.
bool matchesFastCaMo(const fs::path& folder) {
  const fs::path file = findAssociationFile(folder);
  if (file.empty() || fs::exists(folder / "depth.txt") || fs::exists(folder / "calibration.txt"))
    return false;
  if (fs::weakly_canonical(folder).filename().string().find("freiburg") != std::string::npos) return false;
  try {
    std::vector<std::string> ignored;
    return !readAssociations(file, ignored).depth_first;
  } catch (const InputError&) {
    return false;
  }
}

Listing listFastCaMo(const fs::path& folder) {
  Listing listing{.format = kFastCaMoReader.format, .path = folder, .depth_units_per_metre = 1000};
  listing.camera = {{640, 480, 320.0, 320.0, 319.5, 239.5}, "the FastCaMo convention", true};
  listing.frames = readAssociations(findAssociationFile(folder), listing.warnings).frames;
  listing.notes.push_back(
      "taken for FastCaMo, depth in millimetres (the depth scale is assumed): associations.txt has the "
      "colour image "
      "first, and there is no depth.txt; give --depth-units-per-metre (5000 for TUM's images) and "
      "--intrinsics, or "
      "write a sequence.yaml, for data of another kind");
  recogniseFrameNumbers(listing);
  listing.truth = readTruth(folder / "groundtruth.txt", listing.warnings);
  return listing;
}

}  // namespace

const Reader kFastCaMoReader{"FastCaMo", "associations.txt, colour first (FastCaMo)", matchesFastCaMo,
                             listFastCaMo};

}  // namespace rosefusion::datasets
