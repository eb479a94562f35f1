// ICL-NUIM (Handa et al., ICRA 2014), TUM-compatible PNGs: associations.txt with the depth image first and
// frame numbers as stamps; depth in 1/5000 m; rendered with y upwards, hence the negative fy.
#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/association.h"
#include "host/datasets/listing.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

fs::path findTruth(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".freiburg" && !isHidden(entry.path())) return entry.path();
  return folder / "groundtruth.txt";
}

bool matchesIclNuim(const fs::path& folder) {
  const fs::path file = findAssociationFile(folder);
  if (file.empty() || fs::exists(folder / "depth.txt")) return false;
  if (findTruth(folder).extension() == ".freiburg") return true;
  // Without the truth the name must say so: the images are mirrored, and those of an own camera are not.
  const std::string name = lowered(fs::weakly_canonical(folder).filename().string());
  const bool named = name.find("frei_png") != name.npos || name.find("icl") != name.npos ||
                     name.find("living_room") != name.npos || name.find("office_room") != name.npos;
  if (!named) return false;
  try {
    std::vector<std::string> ignored;
    const Associations pairs = readAssociations(file, ignored);
    return pairs.depth_first && stampsAreFrameNumbers(pairs.frames) &&
           !fs::exists(folder / "calibration.txt");
  } catch (const InputError&) {
    return false;  // the reader that takes the folder in the end says what is wrong with the list
  }
}

Listing listIclNuim(const fs::path& folder) {
  Listing listing{.format = kIclNuimReader.format, .path = folder, .depth_units_per_metre = 5000};
  const CameraSource camera{
      {640, 480, 481.2, -480.0, 319.5, 239.5}, "the ICL-NUIM convention (negative fy)", true};
  listing.camera = readCalibration(folder, listing.warnings).value_or(camera);
  listing.frames = readAssociations(findAssociationFile(folder), listing.warnings).frames;
  recogniseFrameNumbers(listing);
  listing.notes.push_back(
      "taken for ICL-NUIM by its name or its *.gt.freiburg; its images are mirrored (negative fy); an own "
      "recording "
      "needs a calibration.txt, or a sequence.yaml");
  listing.truth = readTruth(findTruth(folder), listing.warnings);
  return listing;
}

}  // namespace

const Reader kIclNuimReader{"ICL-NUIM", "associations.txt with *.gt.freiburg (ICL-NUIM)", matchesIclNuim,
                            listIclNuim};

}  // namespace rosefusion::datasets
