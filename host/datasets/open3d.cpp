// Open3D's recorders and the Redwood data sets (Choi et al., 2015): depth/ and color/ (or image/, rgb/) with
// numbered images in millimetres, camera_intrinsic.json, trajectory.log of camera-to-world matrices.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/text_file.h"
#include "host/datasets/association.h"
#include "host/datasets/listing.h"
#include "host/datasets/numbered_files.h"
#include "host/datasets/text_table.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

fs::path findCamera(const fs::path& folder) {
  for (const char* name : {"camera_intrinsic.json", "intrinsic.json", "camera_primesense.json"})
    if (fs::is_regular_file(folder / name)) return folder / name;
  return {};
}

bool matchesOpen3d(const fs::path& folder) {
  const bool described = !findCamera(folder).empty() || fs::is_regular_file(folder / "trajectory.log");
  return described && hasNumberedDepth(folder / "depth");
}

CameraSource readOpen3dCamera(const fs::path& folder) {
  const fs::path file = findCamera(folder);
  if (file.empty()) return {{640, 480, 525, 525, 319.5, 239.5}, "Open3D's PrimeSense convention", true};
  try {
    const nlohmann::json camera = nlohmann::json::parse(readTextFile(file));
    const auto& m = camera.at("intrinsic_matrix");  // column by column
    return {
        {camera.at("width"), camera.at("height"), m.at(0), m.at(4), m.at(6), m.at(7)}, file.string(), false};
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        file.string() +
        ": expected {\"width\", \"height\", \"intrinsic_matrix\": nine numbers, column by column} (" +
        error.what() + ").");
  }
}

void addColourByNumber(Listing& listing, const std::vector<NumberedFile>& depth) {
  std::vector<NumberedFile> colours;
  for (const char* name : {"color", "image", "rgb"})
    if (colours.empty()) colours = numberedColour(listing.path / name);
  std::vector<double> from, to;
  const bool stamped = std::all_of(colours.begin(), colours.end(), [](auto& c) { return c.seconds; });
  for (const NumberedFile& file : depth) from.push_back(stamped ? file.seconds.value_or(NAN) : file.number);
  for (const NumberedFile& file : colours) to.push_back(stamped ? *file.seconds : file.number);
  const auto nearest = associateNearest(from, to, kMaxColourOffset);  // of numbers: the same one
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (nearest[i]) listing.frames[i].colour = colours[*nearest[i]].path;
}

/// Per pose a line of three integers, the first of which is the frame's place in the sequence, and a 4 x 4
/// matrix.
void readTrajectoryLog(Listing& listing) {
  const fs::path file = listing.path / "trajectory.log";
  if (!fs::is_regular_file(file)) return;
  const std::vector<TextRow> rows = readTextTable(file).rows;
  std::size_t skipped = 0;
  std::string first;
  for (std::size_t i = 0; i < rows.size(); i += 5) {
    std::vector<double> numbers;
    bool good = i + 5 <= rows.size() && rows[i].fields.size() == 3;
    for (std::size_t k = i; good && k < i + 5; ++k)
      for (const std::string& field : rows[k].fields)
        good = parseNumber(field, numbers.emplace_back()) && good;
    const double place = good ? numbers[0] : -1;
    Pose pose;
    good = good && place >= 0 && place < static_cast<double>(listing.frames.size()) &&
           poseFromMatrix({numbers.begin() + 3, numbers.end()}, pose);
    if (good)
      listing.truth.push_back({listing.frames[static_cast<std::size_t>(place)].timestamp, pose});
    else if (skipped++ == 0)
      first = "the first: line " + std::to_string(rows[i].line) +
              " does not begin a frame's number and a finite rigid 4x4 pose";
  }
  std::stable_sort(listing.truth.begin(), listing.truth.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
  if (skipped > 0)
    listing.warnings.push_back(file.string() + ": " + std::to_string(skipped) + " poses skipped (" + first +
                               ").");
}

Listing listOpen3d(const fs::path& folder) {
  Listing listing{.format = kOpen3dReader.format, .path = folder, .depth_units_per_metre = 1000};
  listing.camera = readOpen3dCamera(folder);
  const std::vector<NumberedFile> depth = numberedDepth(folder / "depth");
  const bool stamped = std::all_of(depth.begin(), depth.end(), [](auto& d) { return d.seconds; });
  for (const NumberedFile& file : depth)
    listing.frames.push_back({stamped ? *file.seconds : file.number / kFramesPerSecond, file.path, {}, {}});
  if (!stamped) listing.notes.push_back("the files have no time stamps; 30 frames per second assumed");
  addColourByNumber(listing, depth);
  readTrajectoryLog(listing);
  return listing;
}

}  // namespace

const Reader kOpen3dReader{"Open3D recorder", "depth/NNNNNN.png with camera_intrinsic.json (Open3D, Redwood)",
                           matchesOpen3d, listOpen3d};

}  // namespace rosefusion::datasets
