// Stray Scanner (an iPhone's LiDAR): depth/NNNNNN.png in millimetres, confidence/NNNNNN.png (0, 1, 2),
// camera_matrix.csv for the colour video, odometry.csv of ARKit's poses in OpenCV's axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/listing.h"
#include "host/datasets/numbered_files.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

bool matchesStray(const fs::path& folder) {
  return fs::is_regular_file(folder / "camera_matrix.csv") && hasNumberedDepth(folder / "depth");
}

CameraSource readStrayCamera(const fs::path& folder) {
  const fs::path file = folder / "camera_matrix.csv";
  auto k = intrinsicsOf(readNumbers(file));
  if (!k) throw InputError(file.string() + ": expected a 3x3 camera matrix, nine numbers row by row.");
  k->width = 1920, k->height = 1440;  // of the video, which the app always records
  CameraSource camera{*k, file.string(), false};
  camera.of_same_view = true;
  return camera;
}

/// `timestamp, frame, x, y, z, qx, qy, qz, qw`, and more in later versions; by frame.
std::map<int, StampedPose> readOdometry(const fs::path& file, std::vector<std::string>& warnings) {
  std::map<int, StampedPose> poses;
  if (!fs::is_regular_file(file)) return poses;
  std::size_t skipped = 0;
  std::string first;
  for (const TextRow& row : readTextTable(file).rows) {
    if (lowered(row.fields[0]).starts_with("timestamp")) continue;
    std::array<double, 9> v{};
    bool good = row.fields.size() >= v.size();
    for (std::size_t i = 0; good && i < v.size(); ++i) good = parseNumber(row.fields[i], v[i]);
    const Eigen::Quaterniond q(v[8], v[5], v[6], v[7]);
    good = good && std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); }) && v[1] >= 0 &&
           v[1] < 1e9 && q.norm() > 0.1;
    if (good) {
      Pose pose = Pose::Identity();
      pose.linear() = q.normalized().toRotationMatrix();
      pose.translation() = Eigen::Vector3d(v[2], v[3], v[4]);
      poses[static_cast<int>(v[1])] = {v[0], pose};
    } else if (skipped++ == 0) {
      first = "line " + std::to_string(row.line) + " is not 'timestamp, frame, x, y, z, qx, qy, qz, qw'";
    }
  }
  if (skipped > 0) warnings.push_back(skippedLines(file, skipped, first));
  return poses;
}

Listing listStray(const fs::path& folder) {
  Listing listing{.format = kStrayReader.format, .path = folder, .depth_units_per_metre = 1000};
  listing.camera = readStrayCamera(folder);
  const auto poses = readOdometry(folder / "odometry.csv", listing.warnings);
  std::size_t unstamped = 0;
  for (const NumberedFile& file : numberedDepth(folder / "depth")) {
    const auto pose = poses.find(file.number);
    if (pose == poses.end() && !poses.empty()) {
      ++unstamped;
      continue;
    }
    const double stamp = poses.empty() ? file.number / kFramesPerSecond : pose->second.timestamp;
    if (!poses.empty()) listing.truth.push_back(pose->second);
    fs::path confidence = folder / "confidence" / (file.path.stem().string() + ".png");
    if (!fs::exists(confidence)) confidence.clear();
    listing.frames.push_back({stamp, file.path, {}, confidence});
  }
  std::stable_sort(listing.truth.begin(), listing.truth.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
  if (poses.empty())
    listing.notes.push_back("there is no odometry.csv, so that 30 frames per second are assumed");
  else
    listing.notes.push_back("the truth is ARKit's own odometry, good to some centimetres");
  if (unstamped > 0)
    listing.warnings.push_back((folder / "odometry.csv").string() + ": has no line for " +
                               std::to_string(unstamped) + " depth images, which are left out.");
  if (fs::exists(folder / "rgb.mp4"))
    listing.notes.push_back("colour (rgb.mp4) is not read; depth alone is used");
  return listing;
}

}  // namespace

const Reader kStrayReader{"Stray Scanner", "depth/NNNNNN.png with camera_matrix.csv (Stray Scanner)",
                          matchesStray, listStray};

}  // namespace rosefusion::datasets
