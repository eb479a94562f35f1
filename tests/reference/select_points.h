// Reference of pass select_points: the overlap set [eq:validness] on a subsampling grid.
#pragma once
#include <span>
#include <vector>

#include "tests/reference/preprocess.h"

namespace rosefusion::reference {

struct Selection {
  struct Candidate {
    Eigen::Vector3d point;  ///< camera frame
    bool certain = true;    ///< false: rounding decides whether it lies inside the last frame's image
  };
  std::vector<Candidate> points;  ///< grid order; those certainly outside are absent
  std::size_t valid = 0;          ///< grid pixels with a depth
};

/// Pixels (offset_x + i stride, offset_y + j stride). `previous_from_current` null: all valid pixels are
/// selected.
Selection selectPoints(const PointImage& image, const Intrinsics& camera, int stride, int offset_x,
                       int offset_y, const Pose* previous_from_current);

/// `selected`: 4 floats per point, in the order of the pass.
Comparison compare(const Selection& expected, std::span<const float> selected);

}  // namespace rosefusion::reference
