// Whether the true poses and the depth images belong together: the same surface, seen twice, must lie in one
// place.
#pragma once
#include <optional>
#include <string>

#include "host/datasets/sequence.h"

namespace rosefusion {

/// Another reading of the files under which truth and depth agree, where they do not as they are read.
struct TruthDoubt {
  double agreement = 0;  ///< share of the points of one image that lie on the surface of another, as read
  double other_agreement = 0;  ///< the same, read the other way
  std::string reading;         ///< the other way, as in "if ..."
  std::string remedy;
};

/// Share (0 to 1) of a grid of `from`'s points that lie within 2 % of the depth that `to` has there; nothing
/// when fewer than a hundred fall on valid depth. Both images: as Frame::depth.
std::optional<double> depthAgreement(const cv::Mat& from, const cv::Mat& to, const Intrinsics& intrinsics,
                                     double units_per_metre, const Pose& to_from_from);

struct TruthCheck {
  bool agrees = false;              ///< as read; false too where there was nothing to compare
  std::optional<TruthDoubt> doubt;  ///< where another reading does plainly better
};

/// Compares pairs of images between which the true camera moved: as the files are read, with other common
/// depth scales, and with poses written in other common ways. Reads up to twelve images; bad ones are passed
/// over.
TruthCheck checkTruth(Sequence& sequence);

}  // namespace rosefusion
