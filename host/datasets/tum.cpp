// TUM RGB-D (Sturm et al., IROS 2012): depth.txt, rgb.txt, groundtruth.txt; depth in 1/5000 m.
#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "host/core/number_text.h"
#include "host/datasets/association.h"
#include "host/datasets/listing.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr double kUnitsPerMetre = 5000;

/// 1, 2 or 3 when the text names one of the three cameras the data set was recorded with, else 0.
int freiburgNumber(std::string text) {
  text = lowered(text) + ' ';
  for (const std::string_view name : {"freiburg", "fr"})
    for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
      const std::size_t digit = at + name.size();
      const bool longer_number =
          digit + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[digit + 1]));
      if (text[digit] >= '1' && text[digit] <= '3' && !longer_number) return text[digit] - '0';
    }
  return 0;
}

std::string nameOf(const fs::path& folder) {
  return fs::weakly_canonical(folder).filename().string();
}

/// As published for the colour cameras, onto whose images the depth is registered, lens and all.
const CameraSource kFreiburg[] = {
    {{640, 480, 517.3, 516.5, 318.6, 255.3}, "", true, Distortion{0.2624, -0.9531, -0.0054, 0.0026, 1.1633}},
    {{640, 480, 520.9, 521.0, 325.1, 249.7}, "", true, Distortion{0.2312, -0.7849, -0.0033, -0.0001, 0.9172}},
    {{640, 480, 535.4, 539.2, 320.1, 247.6}, "", true, {}}};  // its images are undistorted already

/// The camera that the folder's name, or the list's comments, tell of.
CameraSource conventionalCamera(const fs::path& folder) {
  int camera = freiburgNumber(nameOf(folder));
  if (camera == 0 && fs::exists(folder / "depth.txt"))
    camera = freiburgNumber(readTextTable(folder / "depth.txt").comments);
  if (camera == 0)
    return {{640, 480, 525.0, 525.0, 319.5, 239.5}, "the ROS default for Kinect-like cameras", true, {}};
  CameraSource source = kFreiburg[camera - 1];
  source.source = "TUM freiburg" + std::to_string(camera) + " by name";
  return source;
}

/// A calibration.txt has the pinhole's four numbers only; those of a published camera stand for its lens too.
void addPublishedLens(CameraSource& camera) {
  if (camera.distortion) return;
  for (const CameraSource& published : kFreiburg) {
    Intrinsics k = published.values;
    k.width = camera.values.width, k.height = camera.values.height;
    if (camera.values == k) camera.distortion = published.distortion;
  }
}

/// Says so where less than half of the depth images got a colour image from the list.
void tellUnpaired(const fs::path& list, const char* asked, const std::vector<double>& stamps,
                  Listing& listing) {
  const auto& frames = listing.frames;
  const auto paired =
      std::count_if(frames.begin(), frames.end(), [](const FrameFiles& f) { return !f.colour.empty(); });
  if (2 * static_cast<std::size_t>(paired) >= std::min(frames.size(), stamps.size())) return;
  const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
  const auto earlier = [](const FrameFiles& a, const FrameFiles& b) { return a.timestamp < b.timestamp; };
  const auto [begin, end] = std::minmax_element(frames.begin(), frames.end(), earlier);
  listing.warnings.push_back(printed(
      "%s: only %zu of %zu depth images have a colour image that %s; the others are taken without colour. "
      "The list's stamps run from %.3f to %.3f, those of depth from %.3f to %.3f: if two clocks stamped "
      "them, "
      "bring both lists to one, or write 'depth-stamp depth-file colour-stamp colour-file' lines as "
      "associations.txt.",
      list.c_str(), static_cast<std::size_t>(paired), frames.size(), asked, *first, *last, begin->timestamp,
      end->timestamp));
}

void addColour(const fs::path& folder, Listing& listing) {
  if (const fs::path file = findAssociationFile(folder); !file.empty()) {
    std::map<fs::path, fs::path> colour_of_depth;
    std::vector<double> stamps;
    for (const FrameFiles& pair : readAssociations(file, listing.warnings).frames) {
      colour_of_depth[pair.depth.lexically_normal()] = pair.colour;
      stamps.push_back(pair.timestamp);
    }
    for (FrameFiles& frame : listing.frames)
      if (const auto found = colour_of_depth.find(frame.depth.lexically_normal());
          found != colour_of_depth.end())
        frame.colour = found->second;
    tellUnpaired(file, "names the depth image", stamps, listing);
  } else if (fs::exists(folder / "rgb.txt")) {
    const std::vector<StampedFile> colours = readStampedFiles(folder / "rgb.txt", listing.warnings);
    std::vector<double> depth_stamps, colour_stamps;
    for (const FrameFiles& frame : listing.frames) depth_stamps.push_back(frame.timestamp);
    for (const StampedFile& colour : colours) colour_stamps.push_back(colour.timestamp);
    const auto nearest = associateNearest(depth_stamps, colour_stamps, kMaxColourOffset);
    for (std::size_t i = 0; i < nearest.size(); ++i)
      if (nearest[i]) listing.frames[i].colour = folder / colours[*nearest[i]].file;
    tellUnpaired(folder / "rgb.txt", "lies within 0.02 s", colour_stamps, listing);
  }
}

bool matchesTum(const fs::path& folder) {
  return fs::is_regular_file(folder / "depth.txt") || !findAssociationFile(folder).empty();
}

Listing listTum(const fs::path& folder) {
  Listing listing = listTumLayout(folder, kTumReader.format, conventionalCamera(folder));
  addPublishedLens(listing.camera);
  // Where it lies without its truth, and under another name.
  if (!fs::exists(folder / "depth.txt") && listing.seconds_per_stamp != 1 && listing.camera.assumed)
    listing.notes.push_back(
        "if this is ICL-NUIM, its images are mirrored: put its *.gt.freiburg beside them, or give "
        "--intrinsics 481.2,-480,319.5,239.5");
  return listing;
}

}  // namespace

Listing listTumLayout(const fs::path& folder, const std::string& format, const CameraSource& camera) {
  Listing listing{.format = format, .path = folder, .depth_units_per_metre = kUnitsPerMetre};
  listing.camera = readCalibration(folder, listing.warnings).value_or(camera);
  if (fs::exists(folder / "depth.txt")) {
    for (const StampedFile& depth : readStampedFiles(folder / "depth.txt", listing.warnings))
      listing.frames.push_back({depth.timestamp, folder / depth.file, {}});
    addColour(folder, listing);
  } else {
    listing.frames = readAssociations(findAssociationFile(folder), listing.warnings).frames;
  }
  recogniseFrameNumbers(listing);
  listing.truth = readTruth(folder / "groundtruth.txt", listing.warnings);
  return listing;
}

const Reader kTumReader{"TUM RGB-D", "depth.txt or associations.txt (TUM RGB-D)", matchesTum, listTum};

}  // namespace rosefusion::datasets
