// Reference of passes depth_moments and footprint, in double precision and without a pyramid: every cell of
// every size looks at its own pixels.
#pragma once
#include "tests/reference/preprocess.h"

namespace rosefusion::reference {

struct FootprintOptions {
  double voxel_size = 0.02;
  DepthNoise noise;
  int smallest_cell = 4;  ///< pixels along its side; each of `sizes` is twice as large
  int sizes = 4;
  double deviations = 4;                  ///< of a sum of squares, up to which noise explains it
  double most_variance = 1;               ///< of the plane at a pixel, in those of a depth
  double min_depth = 0.3, max_depth = 6;  ///< metres; what a plane gives beyond is no depth
};

/// What the voxels at each pixel see. Of the cells that hold a pixel, and that are not larger than a voxel at
/// their depth or are the smallest, the largest counts whose depths lie on a plane; its plane gives the depth
/// of the sensor's holes (0 and 65535 of `raw`) and, where it is not larger than a voxel, of the pixels that
/// `own` has a depth for.
PointImage footprint(const PointImage& own, std::span<const std::uint16_t> raw, const Intrinsics& camera,
                     const FootprintOptions& options);

}  // namespace rosefusion::reference
