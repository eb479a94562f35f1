// Intrinsics together with where they come from, and the choice between the caller's, the file's and a
// convention's.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/core/camera.h"
#include "host/datasets/sequence.h"
#include "host/datasets/undistortion.h"

namespace rosefusion::datasets {

struct CameraSource {
  Intrinsics
      values;  ///< width and height: the image size the values hold for; 0 = whatever size the images have
  std::string source;
  bool assumed = false;
  std::optional<Distortion> distortion;  ///< to be removed from the images
  /// Values of a colour image that shows what depth shows: they are scaled to the depth images' size.
  bool of_same_view = false;
};

/// Of the row-major matrix [fx 0 cx; 0 fy cy; 0 0 1] with three or four columns and rows, for images of any
/// size; nothing where the numbers are no such matrix.
std::optional<Intrinsics> intrinsicsOf(const std::vector<double>& matrix);

/// The same lens on an image sampled more coarsely or finely.
Intrinsics scaledTo(const Intrinsics& k, int width, int height);

/// From `folder`/calibration.txt: fx fy cx cy, and k1 k2 p1 p2 k3 where it has eight or nine numbers, or the
/// image's width and height before or behind them where it has six; or a camera matrix. Nothing when there is
/// no such file. Throws InputError when it does not start with four numbers; any other number of them is
/// ignored with a warning.
std::optional<CameraSource> readCalibration(const std::filesystem::path& folder,
                                            std::vector<std::string>& warnings);

/// Fills info.intrinsics (+ source, assumed) and info.depth_units_per_metre (+ assumed) for images of width x
/// height: the caller's options win over `camera`; assumed values for another image size are scaled with a
/// warning. Throws InputError for implausible values or when explicit values are for another image size.
void chooseCamera(const CameraSource& camera, double depth_units_per_metre, bool depth_units_assumed,
                  const SequenceOptions& options, int width, int height, SequenceInfo& info);

}  // namespace rosefusion::datasets
