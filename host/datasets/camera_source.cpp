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

/// Six numbers: four with the image's width and height before or behind them. A lens' coefficients in their
/// place are smaller than a principal point or a size.
std::optional<Intrinsics> withSize(const std::vector<double>& v) {
  constexpr double kLargestCoefficient = 10, kLargestSize = 16384;
  if (v.size() != 6 || v[4] <= kLargestCoefficient || v[5] <= kLargestCoefficient) return std::nullopt;
  // Which two are the size is told by where the principal point then lies: near the middle.
  std::optional<Intrinsics> best;
  double least = 1;
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}}) {
    const double width = v[size], height = v[size + 1];
    const std::size_t k = size == 0 ? 2 : 0;
    const bool whole = width == std::floor(width) && height == std::floor(height);
    if (!whole || width > kLargestSize || height > kLargestSize) continue;
    const double off = std::abs(v[k + 2] / width - 0.5) + std::abs(v[k + 3] / height - 0.5);
    if (off >= least) continue;
    least = off;
    best = Intrinsics{static_cast<int>(width), static_cast<int>(height), v[k], v[k + 1], v[k + 2], v[k + 3]};
  }
  return best;
}

}  // namespace

Intrinsics scaledTo(const Intrinsics& k, int width, int height) {
  const double sx = static_cast<double>(width) / k.width, sy = static_cast<double>(height) / k.height;
  return {width, height, k.fx * sx, k.fy * sy, (k.cx + 0.5) * sx - 0.5, (k.cy + 0.5) * sy - 0.5};
}

std::optional<Intrinsics> intrinsicsOf(const std::vector<double>& v) {
  if (v.size() != 9 && v.size() != 12 && v.size() != 16) return std::nullopt;
  const std::size_t columns = v.size() == 9 ? 3 : 4;
  if (v[1] != 0 || v[columns] != 0 || v[2 * columns] != 0 || v[2 * columns + 1] != 0 ||
      v[2 * columns + 2] != 1)
    return std::nullopt;
  return Intrinsics{0, 0, v[0], v[columns + 1], v[2], v[columns + 2]};
}

std::optional<CameraSource> readCalibration(const std::filesystem::path& folder,
                                            std::vector<std::string>& warnings) {
  const std::filesystem::path file = folder / "calibration.txt";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::vector<double> v = readNumbers(file);
  if (const std::optional<Intrinsics> k = intrinsicsOf(v)) return CameraSource{*k, file.string(), false, {}};
  if (const std::optional<Intrinsics> k = withSize(v)) return CameraSource{*k, file.string(), false, {}};
  if (v.size() < 4) throw InputError(file.string() + ": expected four numbers 'fx fy cx cy' in pixels.");
  CameraSource camera{{0, 0, v[0], v[1], v[2], v[3]}, file.string(), false, {}};
  constexpr double kLargest = 10;  // real lenses stay near 1
  const bool with_lens = v.size() == 8 || v.size() == 9;
  if (with_lens && !std::all_of(v.begin() + 4, v.end(), [](double k) { return std::abs(k) <= kLargest; }))
    throw InputError(file.string() +
                     ": the lens' numbers k1 k2 p1 p2 k3 must lie between -10 and 10; leave them out " +
                     "for images that are undistorted.");
  if (with_lens)
    camera.distortion = {v[4], v[5], v[6], v[7], v.size() == 9 ? v[8] : 0};
  else if (v.size() > 4)
    warnings.push_back(file.string() + ": holds " + std::to_string(v.size()) +
                       " numbers, of which the first four are taken as fx fy cx cy; a lens' distortion takes "
                       "four or five more (k1 k2 p1 p2 k3), an image size two before or behind them.");
  return camera;
}

void chooseCamera(const CameraSource& camera, double depth_units_per_metre, bool depth_units_assumed,
                  const SequenceOptions& options, int width, int height, SequenceInfo& info) {
  info.opened_with = options;
  Intrinsics k = options.intrinsics.value_or(camera.values);
  info.intrinsics_source = options.intrinsics ? "the given intrinsics" : camera.source;
  info.intrinsics_assumed = !options.intrinsics && camera.assumed;
  const bool other_size = k.width > 0 && k.height > 0 && (k.width != width || k.height != height);
  const double stretch = other_size ? static_cast<double>(k.width) * height / k.height / width : 1;
  const bool same_view = !options.intrinsics && camera.of_same_view && std::abs(stretch - 1) < 0.02;
  if (other_size && !info.intrinsics_assumed && !same_view)
    throw InputError(info.intrinsics_source + ": the intrinsics are for " + sizeText(k.width, k.height) +
                     " images, but the depth images of " + info.path.string() + " are " +
                     sizeText(width, height) + "; give intrinsics for that size.");
  if (same_view && other_size) k = scaledTo(k, width, height);
  if (other_size && !same_view) {
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
  info.depth_units_assumed = !options.depth_units_per_metre && depth_units_assumed;
  const double units = info.depth_units_per_metre;
  if (!std::isfinite(units) || units < 1 || units > 1e6)
    throw InputError(info.path.string() + ": depth_units_per_metre is " + printed("%g", units) +
                     "; give how many depth units make a metre, 1 to 1000000 (1000 for millimetres).");
}

}  // namespace rosefusion::datasets
