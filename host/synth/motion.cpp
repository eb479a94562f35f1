#include "host/synth/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/core/error.h"
#include "host/synth/view.h"

namespace rosefusion {
namespace {

Pose poseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation) {
  return Eigen::Translation3d(position) * rotation * Pose::Identity();
}

template <typename PoseAt>
Trajectory sample(const SynthOptions& options, const PoseAt& pose_at) {
  Trajectory trajectory;
  for (int i = 0; i < options.frames; ++i) {
    const double t = i / options.fps;
    trajectory.push_back({t, pose_at(t)});
  }
  return trajectory;
}

double durationOf(const SynthOptions& options) {
  return (options.frames - 1) / options.fps;
}

struct Line {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  double length() const { return (to - from).norm(); }
};

/// A straight, clear line of up to `longest` metres, the longest of many tried.
Line findLine(const FreeSpace& space, double longest, Rng& rng) {
  Line best;
  for (int attempt = 0; attempt < 600 && best.length() < 0.98 * longest; ++attempt) {
    const Eigen::Vector3d& from = space.randomCell(rng);
    Eigen::Vector3d direction = rng.direction();
    direction = (direction - 0.7 * direction.dot(space.up()) * space.up()).normalized();
    for (double length = longest; length > best.length(); length -= 0.1) {
      const Eigen::Vector3d to = from + length * direction;
      if (!space.contains(to) || !space.isSegmentClear(from, to, kPathClearance)) continue;
      best = {from, to};
      break;
    }
  }
  if (best.length() < 0.3)
    throw InputError(
        "The scene has no clear straight line to move along; try another seed or a larger mesh.");
  return best;
}

/// Share of the way, 0 to 1, at x in [0, 1] of a stroke whose speed rises and falls smoothly within `edge` at
/// either end and is even in between. Its highest speed is 1 / (1 - edge).
double strokeProgress(double x, double edge) {
  const auto rising = [&](double y) {  // integral of sin^2 ramps
    return y / 2 - edge / (2 * std::numbers::pi) * std::sin(std::numbers::pi * y / edge);
  };
  if (x < edge) return rising(x) / (1 - edge);
  if (x > 1 - edge) return 1 - rising(1 - x) / (1 - edge);
  return (x - edge / 2) / (1 - edge);
}

}  // namespace

Trajectory sixDofMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng) {
  const SpeedProfile linear(options.linear, durationOf(options), options.ramp, rng);
  const SpeedProfile angular(options.angular, durationOf(options), options.ramp, rng);
  const PositionSpline path = options.loops > 0
                                  ? tour(space, linear.total() / options.loops, options.loops, rng)
                                  : wander(space, linear.total(), rng);
  const RotationSpline gaze = lookAround(
      space, options, angular.total(),
      [&](double angle) { return path.at(linear.travelled(angular.timeAt(angle))); }, rng);
  return sample(
      options, [&](double t) { return poseOf(path.at(linear.travelled(t)), gaze.at(angular.travelled(t))); });
}

Trajectory rotationMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng) {
  Eigen::Vector3d spot = space.randomCell(rng);
  for (int i = 0; i < 200; ++i) {  // the middle of the room rather than a corner
    const Eigen::Vector3d& other = space.randomCell(rng);
    if (space.tracer().clearance(other, 1.5) > space.tracer().clearance(spot, 1.5)) spot = other;
  }
  const SpeedProfile angular(options.angular, durationOf(options), options.ramp, rng);
  const RotationSpline gaze = lookAround(
      space, options, angular.total(), [&](double) { return spot; }, rng);
  return sample(options, [&](double t) { return poseOf(spot, gaze.at(angular.travelled(t))); });
}

Trajectory linearMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng) {
  // Strokes to and fro. A stroke of peak speed v with smooth ends of share e has mean v (1 - e): e = 1/2
  // where the mean asked for allows it.
  const double high = options.linear.high * 0.985;
  const double edge = std::clamp(1 - options.linear.mean / (0.8 * high), 0.1, 0.5);
  const double least_peak = std::clamp(2 * options.linear.mean / (1 - edge) - high, 0.1 * high, high);
  const Line line = findLine(space, std::clamp(0.7 * options.linear.mean, 1.0, 3.5), rng);
  const double length = line.length();
  const Eigen::Vector3d direction = (line.to - line.from) / length;

  Eigen::Quaterniond best = Eigen::Quaterniond::Identity();
  double best_score = -std::numeric_limits<double>::max();
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d forward = rng.direction();
    forward -= 0.8 * forward.dot(space.up()) * space.up();
    const Eigen::Quaterniond rotation = lookAlong(forward, space.up());
    double worst = std::numeric_limits<double>::max();
    for (int j = 0; j <= 4; ++j)
      worst = std::min(
          worst, judgeView(space.tracer(), options.intrinsics,
                           poseOf(line.from + j / 4.0 * length * direction, rotation), options.max_depth)
                     .score());
    if (worst > best_score) best_score = worst, best = rotation;
  }

  struct Stroke {
    double start, duration, from, to;
  };
  std::vector<Stroke> strokes;
  double time = 0, at = 0;
  for (int i = 0; time < durationOf(options); ++i) {
    const double to = i % 2 ? rng.uniform(0, 0.12) * length : length * rng.uniform(0.88, 1);
    // The second stroke is the fastest one, so that every sequence reaches its highest speed.
    const double peak = i == 1 ? high : rng.uniform(least_peak, high);
    strokes.push_back({time, std::abs(to - at) / (peak * (1 - edge)), at, to});
    time += strokes.back().duration;
    at = to;
  }
  return sample(options, [&](double t) {
    auto stroke = std::upper_bound(strokes.begin(), strokes.end(), t,
                                   [](double moment, const Stroke& s) { return moment < s.start; }) -
                  1;
    const double x = std::clamp((t - stroke->start) / stroke->duration, 0.0, 1.0);
    const double along = stroke->from + (stroke->to - stroke->from) * strokeProgress(x, edge);
    return poseOf(line.from + along * direction, best);
  });
}

Trajectory makeTrajectory(const Tracer& tracer, const SynthOptions& options, const std::string& source) {
  Rng rng(options.seed, 2);
  if (options.motion == Motion::Around) return aroundMotion(tracer, options, rng);
  const FreeSpace space(tracer, options.threads, source);
  switch (options.motion) {
    case Motion::Linear:
      return linearMotion(space, options, rng);
    case Motion::Rotation:
      return rotationMotion(space, options, rng);
    case Motion::Replay:
      return replayMotion(space, options, rng);
    case Motion::Around:
    case Motion::SixDof:
      break;
  }
  return sixDofMotion(space, options, rng);
}

MotionStatistics motionStatistics(const Trajectory& trajectory, const Tracer& tracer) {
  MotionStatistics s;
  s.clearance = std::numeric_limits<double>::max();
  double turned = 0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose& pose = trajectory[i].world_from_camera;
    s.clearance = std::min(s.clearance, tracer.clearance(pose.translation(), 10));
    if (i == 0) continue;
    const Pose& last = trajectory[i - 1].world_from_camera;
    const double seconds = trajectory[i].timestamp - trajectory[i - 1].timestamp;
    const double step = (pose.translation() - last.translation()).norm();
    const double angle = rotationAngle(last.inverse() * pose);
    s.length += step;
    turned += angle;
    s.linear_max = std::max(s.linear_max, step / seconds);
    s.angular_max = std::max(s.angular_max, angle / seconds);
  }
  const double duration = trajectory.back().timestamp - trajectory.front().timestamp;
  s.linear_mean = s.length / duration;
  s.angular_mean = turned / duration;
  return s;
}

}  // namespace rosefusion
