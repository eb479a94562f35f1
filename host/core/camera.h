// The pinhole camera model, shared with poses (se3.h) by everything on the host.
#pragma once
#include <string>

#include "host/core/se3.h"

namespace rosefusion {

/// Pinhole intrinsics in pixels; pixel centres have integer coordinates. fy is negative for ICL-NUIM.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;

  /// Point in the camera frame (metres) seen at pixel (u, v) at depth z along the optical axis.
  Eigen::Vector3d unproject(double u, double v, double z) const {
    return {(u - cx) / fx * z, (v - cy) / fy * z, z};
  }
  /// Pixel coordinates of a camera-frame point with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  bool operator==(const Intrinsics&) const = default;
};

/// Throws InputError, naming `source` (the file or setting they came from), for zero, non-finite or absurd
/// values: focal lengths outside 0.1 to 10 image widths, or a principal point outside the image.
void requirePlausible(const Intrinsics& intrinsics, const std::string& source);

}  // namespace rosefusion
