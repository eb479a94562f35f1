// The cameras of ScanNet's recordings.
#pragma once
#include <cmath>

#include "host/datasets/camera_source.h"

namespace rosefusion::datasets {

/// The depth camera where no file names it.
inline const CameraSource kScanNetCamera{
    {640, 480, 577.87, 577.87, 319.5, 239.5}, "the ScanNet convention", true};

/// Whether a colour image shows what the depth image shows, at its own size: the optical axes stand at the
/// same angles to the images' edges.
inline bool isSameView(const Intrinsics& depth, const Intrinsics& colour) {
  constexpr double kTolerance = 0.02;  // radians
  const auto apart = [](double c1, double f1, double c2, double f2) {
    return std::abs((c1 + 0.5) / f1 - (c2 + 0.5) / f2);
  };
  return apart(depth.cx, depth.fx, colour.cx, colour.fx) < kTolerance &&
         apart(depth.cy, depth.fy, colour.cy, colour.fy) < kTolerance;
}

}  // namespace rosefusion::datasets
