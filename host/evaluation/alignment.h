// The rigid transform that brings an estimated trajectory into the frame of the truth.
#pragma once
#include <string>
#include <vector>

#include "host/evaluation/association.h"

namespace rosefusion {

struct Alignment {
  Pose truth_from_estimate = Pose::Identity();
  /// False when the positions alone leave the rotation open (fewer than three poses, no motion, or motion
  /// along one line); what they leave open is then chosen so that the orientations agree best.
  bool positions_suffice = false;
  std::string description;  ///< how it was aligned, for people
};

/// Least-squares SE(3) alignment of the camera positions, without scale: Umeyama, "Least-squares estimation
/// of transformation parameters between two point patterns", PAMI 1991. A proper rotation in every case; the
/// identity for no pairs.
///
/// `lever_m` > 0 lets the orientations count as well, as if each camera carried three points at that distance
/// along its axes: what a camera sees then aligns better than its positions alone would align it, above all
/// when the camera mostly turned on the spot. 0 is the alignment that the absolute trajectory error is
/// defined with.
Alignment alignPoses(const std::vector<PosePair>& pairs, double lever_m = 0);

}  // namespace rosefusion
