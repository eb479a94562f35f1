#include "host/datasets/camera_source.h"

#include <algorithm>
#include <cmath>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// The same lens on an image sampled more coarsely or finely; pixel centres have integer coordinates.
Intrinsics scaledTo(const Intrinsics& k, int width, int height) {
  const double sx = static_cast<double>(width) / k.width, sy = static_cast<double>(height) / k.height;
  return {width, height, k.fx * sx, k.fy * sy, (k.cx + 0.5) * sx - 0.5, (k.cy + 0.5) * sy - 0.5};
}

}  // namespace

std::optional<CameraSource> readCalibration(const std::filesystem::path& folder,
                                            std::vector<std::string>& warnings) {
  const std::filesystem::path file = folder / "calibration.txt";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::vector<double> v = readNumbers(file);
  // The matrix [fx 0 cx; 0 fy cy; 0 0 1], as many tools write it.
  const bool matrix = v.size() == 9 && v[1] == 0 && v[3] == 0 && v[6] == 0 && v[7] == 0 && v[8] == 1;
  if (matrix) return CameraSource{{0, 0, v[0], v[4], v[2], v[5]}, file.string(), false, {}};
  if (v.size() < 4) throw InputError(file.string() + ": expected four numbers 'fx fy cx cy' in pixels.");
  CameraSource camera{{0, 0, v[0], v[1], v[2], v[3]}, file.string(), false, {}};
  constexpr double kLargest = 10;  // real lenses stay near 1
  if (v.size() == 9 && !std::all_of(v.begin() + 4, v.end(), [](double k) { return std::abs(k) <= kLargest; }))
    throw InputError(file.string() +
                     ": the lens' numbers k1 k2 p1 p2 k3 must lie between -10 and 10; leave them out " +
                     "for images that are undistorted.");
  if (v.size() == 9)
    camera.distortion = {v[4], v[5], v[6], v[7], v[8]};
  else if (v.size() > 4)
    warnings.push_back(file.string() +
                       ": only fx fy cx cy are used; a lens' distortion takes five more, k1 k2 p1 p2 k3.");
  return camera;
}

void chooseCamera(const CameraSource& camera, double depth_units_per_metre, const SequenceOptions& options,
                  int width, int height, SequenceInfo& info) {
  Intrinsics k = options.intrinsics.value_or(camera.values);
  info.intrinsics_source = options.intrinsics ? "the given intrinsics" : camera.source;
  info.intrinsics_assumed = !options.intrinsics && camera.assumed;
  const bool other_size = k.width > 0 && k.height > 0 && (k.width != width || k.height != height);
  if (other_size && !info.intrinsics_assumed)
    throw InputError(info.intrinsics_source + ": the intrinsics are for " + sizeText(k.width, k.height) +
                     " images, but the depth images of " + info.path.string() + " are " +
                     sizeText(width, height) + "; give intrinsics for that size.");
  if (other_size) {
    info.warnings.push_back(info.path.string() + ": the assumed intrinsics (" + info.intrinsics_source +
                            ") are for " + sizeText(k.width, k.height) + " images and were scaled to " +
                            sizeText(width, height) + ".");
    k = scaledTo(k, width, height);
  }
  k.width = width;
  k.height = height;
  requirePlausible(k, info.intrinsics_source);
  info.intrinsics = k;

  info.depth_units_per_metre = options.depth_units_per_metre.value_or(depth_units_per_metre);
  const double units = info.depth_units_per_metre;
  if (!std::isfinite(units) || units < 1 || units > 1e6)
    throw InputError(info.path.string() + ": depth_units_per_metre is " + printed("%g", units) +
                     "; give how many depth units make a metre, 1 to 1000000 (1000 for millimetres).");
}

}  // namespace rosefusion::datasets
