// Orientations: a random walk of rotation keys, each chosen for what the camera sees on the way to it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/synth/motion.h"
#include "host/synth/view.h"

namespace rosefusion {
namespace {

constexpr double kKeyAngle = 0.3;       // radians between keys
constexpr int kJudgedKeys = 14;         // judged for each key
constexpr double kMaxAxisCosine = 0.3;  // between successive rotation axes, against cusps
constexpr double kLowestPitch = -0.75, kHighestPitch = 0.4, kMostRoll = 0.35;  // radians

double pitchOf(const Eigen::Quaterniond& q, const Eigen::Vector3d& up) {
  return std::asin(std::clamp(up.dot(q * Eigen::Vector3d::UnitZ()), -1.0, 1.0));
}

double rollOf(const Eigen::Quaterniond& q, const Eigen::Vector3d& up) {
  return std::asin(std::clamp(up.dot(q * Eigen::Vector3d::UnitX()), -1.0, 1.0));
}

/// How far pitch and roll leave their ranges, radians.
double excess(const Eigen::Quaterniond& q, const Eigen::Vector3d& up) {
  const double pitch = pitchOf(q, up);
  return std::max({0.0, pitch - kHighestPitch, kLowestPitch - pitch}) +
         std::max(0.0, std::abs(rollOf(q, up)) - kMostRoll);
}

}  // namespace

Eigen::Quaterniond lookAlong(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  Eigen::Matrix3d axes;
  axes.col(2) = forward.normalized();
  axes.col(0) = axes.col(2).cross(up).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Eigen::Quaterniond(axes);
}

RotationSpline lookAround(const FreeSpace& space, const SynthOptions& options, double length,
                          const std::function<Eigen::Vector3d(double)>& position_at, Rng& rng) {
  const auto score = [&](double angle, const Eigen::Quaterniond& q) {
    const Pose pose = Eigen::Translation3d(position_at(angle)) * q * Pose::Identity();
    const ViewQuality quality = judgeView(space.tracer(), options.intrinsics, pose, options.max_depth);
    return quality.score() - (quality.isAcceptable() ? 0 : 1);
  };

  Eigen::Quaterniond first = Eigen::Quaterniond::Identity();
  double first_score = -std::numeric_limits<double>::max();
  for (int i = 0; i < 60; ++i) {
    Eigen::Vector3d forward = rng.direction();
    forward -= 0.8 * forward.dot(space.up()) * space.up();
    const Eigen::Quaterniond q = lookAlong(forward, space.up());
    const double s = score(0, q);
    if (s > first_score) first_score = s, first = q;
  }
  RotationSpline spline;
  Eigen::Vector3d axis = (rng.chance(0.5) ? 1 : -1) * space.up();  // world frame
  for (int i = 0; i < 3; ++i) spline.push(Eigen::Quaterniond(Eigen::AngleAxisd((i - 1) * 0.1, axis)) * first);

  while (spline.length() < length || spline.keys().size() < 4) {
    const Eigen::Quaterniond last = spline.keys().back();
    const Eigen::Vector3d right = last * Eigen::Vector3d::UnitX(), forward = last * Eigen::Vector3d::UnitZ();
    Eigen::Quaterniond best = last;
    Eigen::Vector3d best_axis = axis;
    double best_score = -std::numeric_limits<double>::max();
    for (int judged = 0, drawn = 0; judged < kJudgedKeys && drawn < 2000; ++drawn) {
      const Eigen::Vector3d turn =
          (rng.normal() * space.up() + 0.6 * rng.normal() * right + 0.3 * rng.normal() * forward)
              .normalized();
      if (turn.dot(axis) < kMaxAxisCosine) continue;
      const Eigen::Quaterniond q =
          (Eigen::Quaterniond(Eigen::AngleAxisd(kKeyAngle, turn)) * last).normalized();
      ++judged;
      double worst = std::numeric_limits<double>::max();
      spline.push(q);
      const double end = spline.length();
      for (const double back : {0.0, 0.5, 1.0})
        worst = std::min(worst, score(end - back * kKeyAngle, spline.at(end - back * kKeyAngle)));
      // Where this key leads to: the curve reaches it only with the keys to come.
      worst = std::min(worst, score(end + kKeyAngle, q));
      spline.pop();
      const double s = worst - 8 * excess(q, space.up()) + 0.3 * rng.uniform();
      if (s > best_score) best_score = s, best = q, best_axis = turn;
    }
    spline.push(best);
    axis = best_axis;
  }
  return spline;
}

}  // namespace rosefusion
