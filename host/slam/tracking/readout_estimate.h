// Rolling shutter, measured: how long after an image's first row its last one was exposed.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/passes/refine.h"
#include "host/core/camera.h"

namespace rosefusion {

/// What one frame says of the readout, in units of the time since the last frame: the information (inverse
/// variance) of its measure, and that times the measure.
struct ReadoutEvidence {
  double information = 0, weighted = 0;
};

/// A row exposed at another time than the middle one was seen from another pose, so that the rows' own best
/// poses lie along the camera's motion. `bands`: normal equations of bands of rows, at the frame's pose;
/// `motion`: the step of moved() from the last frame's pose to this one; `variance`: of a residual of weight
/// 1, square metres.
ReadoutEvidence readoutEvidence(std::span<const RefineSums> bands, const Vector6& motion,
                                const Intrinsics& intrinsics, double variance);

/// A value; of a camera, not of a map.
class ReadoutEstimate {
 public:
  /// `applied`: seconds that the frame's images had been corrected by; `interval`: since the last frame.
  void add(const ReadoutEvidence& evidence, double applied, double interval);
  /// Seconds from the first row to the last, negative from the bottom up; 0 as long as none is certain.
  double seconds() const;
  double deviation() const;

 private:
  int frames_ = 0;
  double information_ = 0, weighted_ = 0, squares_ = 0;  ///< sums over the frames: 1 / s^2, 1 / s, 1
};

}  // namespace rosefusion
