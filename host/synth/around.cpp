// A hand that carries the camera before a desk, and turns around an object.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/error.h"
#include "host/synth/motion.h"

namespace rosefusion {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kHandClearance = 0.15;  // metres to every surface

Pose looking(const Eigen::Vector3d& from, const Eigen::Vector3d& at, double roll, const Eigen::Vector3d& up) {
  return Eigen::Translation3d(from) * lookAlong(at - from, up) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * Pose::Identity();
}

/// From the desk's front, which faces along +y.
Trajectory beforeDesk(const Tracer& tracer, const SynthOptions& options, Rng& rng) {
  const Subject& desk = tracer.scene().subject;
  const SpeedProfile speed(options.linear, (options.frames - 1) / options.fps, options.ramp, rng);
  PositionSpline path, gaze;
  const auto isClear = [&] {
    const auto& keys = path.keys();
    for (int i = 0; keys.size() >= 4 && i <= 12; ++i)
      if (tracer.clearance(blend(&keys[keys.size() - 4], i / 12.0), 1) < kHandClearance) return false;
    return true;
  };
  double azimuth = rng.uniform(-0.5, 0.5);
  for (int drawn = 0; path.keys().size() < 4 || path.length() < speed.total(); ++drawn) {
    if (drawn > 100000) throw InputError("The desk leaves no way for a camera around it; try another seed.");
    const Eigen::Vector3d at = desk.centre + Eigen::Vector3d(rng.uniform(-0.6, 0.6) * desk.half.x(),
                                                             rng.uniform(-0.6, 0.4) * desk.half.y(), 0.08);
    const double around = std::clamp(azimuth + rng.uniform(-0.7, 0.7), -1.1, 1.1),
                 above = rng.uniform(0.3, 1.05),
                 away = std::max(rng.uniform(0.45, 1), options.sensor.nearest + 0.15);
    const Eigen::Vector3d key =
        at + away * Eigen::Vector3d(std::cos(above) * std::sin(around), std::cos(above) * std::cos(around),
                                    std::sin(above));
    if (tracer.clearance(key, 1) < kHandClearance) continue;
    if (!path.keys().empty())
      if (const double step = (key - path.keys().back()).norm(); step < 0.12 || step > 0.45) continue;
    path.push(key);
    if (!isClear()) {
      path.pop();
      continue;
    }
    gaze.push(at);
    azimuth = around;
  }
  Trajectory motion;
  const double sway = rng.uniform(0, kTurn);
  for (int i = 0; i < options.frames; ++i) {
    const double t = i / options.fps, along = speed.travelled(t);
    // The gaze moves with the hand: as much of its own way as the hand has of its.
    const Eigen::Vector3d at = gaze.at(along / path.length() * gaze.length());
    motion.push_back({t, looking(path.at(along), at, 0.12 * std::sin(3 * along + sway), tracer.scene().up)});
  }
  return motion;
}

Trajectory aroundObject(const Tracer& tracer, const SynthOptions& options, Rng& rng) {
  const Subject& object = tracer.scene().subject;
  const double away = object.half.norm() + std::max(rng.uniform(0.35, 0.5), options.sensor.nearest + 0.1),
               above = rng.uniform(0.3, 0.6);
  const double start = rng.uniform(0, kTurn), a = rng.uniform(0, kTurn), b = rng.uniform(0, kTurn);
  const SpeedProfile speed(options.linear, (options.frames - 1) / options.fps, options.ramp, rng);
  const auto poseAt = [&](double turned) {
    // Whole waves a turn, so that the last view of a turn is its first.
    const double r = away * (1 + 0.05 * std::sin(turned + a) + 0.03 * std::sin(3 * turned + b)),
                 up = above + 0.12 * std::sin(2 * turned + b), angle = start + turned;
    const Eigen::Vector3d from =
        object.centre +
        r * Eigen::Vector3d(std::cos(up) * std::cos(angle), std::cos(up) * std::sin(angle), std::sin(up));
    const Eigen::Vector3d at =
        object.centre +
        0.1 * object.half.z() * Eigen::Vector3d(std::sin(turned + b), 0, std::cos(3 * turned));
    return looking(from, at, 0.06 * std::sin(2 * turned + a), tracer.scene().up);
  };
  Trajectory motion;
  double turned = 0;
  for (int i = 0; i < options.frames; ++i) {
    const double t = i / options.fps;
    motion.push_back({t, poseAt(turned)});
    if (options.turn_per_frame > 0) {
      turned += options.turn_per_frame;
    } else {
      const double wanted = speed.travelled((i + 1) / options.fps) - speed.travelled(t);
      // The path winds a little: what a small turn covers here says how far to turn.
      constexpr double kSmall = 1e-3;
      const double covered = (poseAt(turned + kSmall).translation() - poseAt(turned).translation()).norm();
      turned += wanted * kSmall / covered;
    }
  }
  return motion;
}

}  // namespace

Trajectory aroundMotion(const Tracer& tracer, const SynthOptions& options, Rng& rng) {
  return options.scene == SceneKind::Object ? aroundObject(tracer, options, rng)
                                            : beforeDesk(tracer, options, rng);
}

}  // namespace rosefusion
