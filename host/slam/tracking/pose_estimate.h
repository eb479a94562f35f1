// A pose and how well the depth fits there: what every search of poses returns. Three types, since three
// things are asked: PoseScore what every method's status follows from, on the same pixels whichever method it
// was; PoseFit what a refinement knows of the pose where it ended; TrackResult what a search found and spent.
// Starts of searches (ScannedPose and PoseHypothesis) have no fit yet, and what is made of a result
// (VerifiedPose, FrameResult) holds these.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/camera.h"
#include "host/slam/tracking/readout_estimate.h"

namespace rosefusion {

/// Up to so many times refine.least_constraint errors of the model can still carry a pose along, and a wrong
/// place seems to hold it
/// (tests/bench/notes/relocalisation.md#found-where-its-motion-leads-and-slides-that-show).
inline constexpr double kWeakConstraint = 4;

/// How well the depth fits the model at a pose, over the overlap with the last frame.
struct PoseScore {
  double residual = 1;     ///< in truncations: RMS of psi, or its mean size with swarm.loss = absolute
  double overlap = 0;      ///< share of the valid pixels that fall inside the last frame's image
  double valid_share = 0;  ///< share of the grid's pixels with valid depth
};

/// How the depth fits the model at a pose. Shares are of the frame's valid pixels on the grid looked at.
struct PoseFit {
  Pose world_from_camera = Pose::Identity();
  double cost = 1;            ///< robust, in [0, 1]: 1 where no point finds a surface
  double observed_ratio = 0;  ///< share that reads a distance
  double inlier_ratio = 0;    ///< share nearer to the surface than refine.huber or twice the depth's noise
  double observability = 0;   ///< how well depth and, where it was asked, colour hold the direction they hold
                              ///< least (smallest eigenvalue); a plane's own is 1
  /// Columns, in the world and of length 1: where most of the surfaces in view face, across each other.
  Eigen::Matrix3d normals = Eigen::Matrix3d::Identity();
  /// Of a step of moved() (se3.h): metres and radians. What the depth's noise leaves open, at most 1 m and 1
  /// rad; zero where no point finds a surface.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  ReadoutEvidence readout;  ///< of rows that were not exposed at once
  double colour_cost = 0;   ///< the same of the luminance, in units of `cost`; 0 where colour was not asked

  /// Standard deviations along the worst direction: of the shift, metres; of the turn, radians.
  double shiftDeviation() const;
  double turnDeviation() const;
  /// Whether a pose is accepted by this alone: at least `share` of the pixels reads a distance, three
  /// quarters of those are inliers, and every direction is held by `least_constraint`.
  bool holds(double share, double least_constraint) const {
    return observed_ratio >= share && inlier_ratio >= 0.75 * observed_ratio &&
           observability >= least_constraint;
  }
};

/// What a search of any method found.
struct TrackResult {
  Pose world_from_camera = Pose::Identity();
  int iterations = 0;
  std::uint64_t lookups = 0;        ///< TSDF voxels read; of icp the pixels paired
  std::optional<PoseFit> fit;       ///< where the refinement ended; empty without it
  std::vector<PoseFit> candidates;  ///< of a search of the whole model: distinct poses, least cost first
  /// Of the best of all starts, on few pixels: what a frame's is compared with those before it by. None of
  /// methods that do not ask.
  std::optional<double> cost;
};

}  // namespace rosefusion
