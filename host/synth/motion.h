// The kinds of motion: each makes one pose per frame, world_from_camera, collision-free.
#pragma once
#include <functional>

#include "host/core/trajectory.h"
#include "host/synth/arc_spline.h"
#include "host/synth/free_space.h"
#include "host/synth/options.h"

namespace rosefusion {

/// A curve of at least `length` metres that wanders through the free space without sharp turns and keeps
/// kPathClearance. Throws InputError when the space is too small for it.
PositionSpline wander(const FreeSpace& space, double length, Rng& rng);

/// A closed tour through the free space, walked `loops` times, each lap a little different. `lap_length`
/// metres is what the tour is planned for; it comes out somewhat longer or, in a small space, shorter.
PositionSpline tour(const FreeSpace& space, double lap_length, int loops, Rng& rng);

/// A curve of rotations at least `length` radians long, whose views, taken from position_at(angle travelled),
/// look into the room rather than at a wall in front of the lens.
RotationSpline lookAround(const FreeSpace& space, const SynthOptions& options, double length,
                          const std::function<Eigen::Vector3d(double)>& position_at, Rng& rng);

/// Camera orientation with forward direction `forward` and no roll.
Eigen::Quaterniond lookAlong(const Eigen::Vector3d& forward, const Eigen::Vector3d& up);

Trajectory sixDofMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng);
Trajectory linearMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng);
Trajectory rotationMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng);
/// At most options.frames poses: it ends where the recording ends.
Trajectory replayMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng);

/// Around scene.subject: by hand to and fro before a desk, 0.45 to 1 m from what is looked at; around an
/// object in turns that close.
Trajectory aroundMotion(const Tracer& tracer, const SynthOptions& options, Rng& rng);

/// The one that options.motion names, seeded by options.seed; where it needs free space, found in the scene
/// that `source` names in errors.
Trajectory makeTrajectory(const Tracer& tracer, const SynthOptions& options, const std::string& source);

/// Speeds from frame to frame, and how the views look.
struct MotionStatistics {
  double linear_mean = 0, linear_max = 0;    ///< m/s
  double angular_mean = 0, angular_max = 0;  ///< rad/s
  double length = 0;                         ///< metres
  double clearance = 0;                      ///< least distance to a surface, metres
};
MotionStatistics motionStatistics(const Trajectory& trajectory, const Tracer& tracer);

}  // namespace rosefusion
