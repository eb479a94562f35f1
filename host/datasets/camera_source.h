// Intrinsics together with where they come from, and the choice between the caller's, the file's and a
// convention's.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/camera.h"
#include "host/datasets/sequence.h"

namespace rosefusion::datasets {

struct CameraSource {
  Intrinsics
      values;  ///< width and height: the image size the values hold for; 0 = whatever size the images have
  std::string source;
  bool assumed = false;
};

/// fx fy cx cy from `folder`/calibration.txt; nothing when there is no such file. Throws InputError when it
/// does not start with four numbers; further numbers (distortion) are ignored with a warning.
std::optional<CameraSource> readCalibration(const std::filesystem::path& folder,
                                            std::vector<std::string>& warnings);

/// Fills info.intrinsics (+ source, assumed) and info.depth_units_per_metre for images of width x height: the
/// caller's options win over `camera`; assumed values for another image size are scaled with a warning.
/// Throws InputError for implausible values or when explicit values are for another image size.
void chooseCamera(const CameraSource& camera, double depth_units_per_metre, const SequenceOptions& options,
                  int width, int height, SequenceInfo& info);

}  // namespace rosefusion::datasets
