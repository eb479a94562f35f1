// Recorded motion, faster, moved to where the room has space for it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/synth/motion.h"
#include "host/synth/view.h"

namespace rosefusion {
namespace {

constexpr int kPlacements = 40000;  // tried; nearly all fail at their first pose
constexpr int kJudged = 12;         // collision-free placements to choose among

/// The axis of the recording's frame that its camera held upwards on average.
Eigen::Vector3d upOf(const Trajectory& recorded) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const StampedPose& p : recorded) sum -= p.world_from_camera.linear().col(1);
  int axis = 0;
  sum.cwiseAbs().maxCoeff(&axis);
  return (sum[axis] < 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);
}

Trajectory resample(const Trajectory& recorded, const SynthOptions& options) {
  Trajectory result;
  const double start = recorded.front().timestamp;
  for (int i = 0; i < options.frames; ++i) {
    StampedPose pose{i / options.fps, Pose::Identity()};
    if (!interpolate(recorded, start + pose.timestamp * options.replay_speed, 1e-9, pose.world_from_camera) &&
        start + pose.timestamp * options.replay_speed > recorded.back().timestamp)
      break;
    // Gaps in the recording are bridged: the camera went somewhere in between.
    interpolate(recorded, start + pose.timestamp * options.replay_speed, 1e9, pose.world_from_camera);
    result.push_back(pose);
  }
  return result;
}

}  // namespace

Trajectory replayMotion(const FreeSpace& space, const SynthOptions& options, Rng& rng) {
  const Trajectory recorded = readTumTrajectory(options.replay_file);
  Trajectory motion = recorded.size() < 2 ? Trajectory{} : resample(recorded, options);
  if (motion.size() < 2)
    throw InputError(
        options.replay_file.string() +
        ": the recording is too short for this speed; lower --replay-speed or give a longer one.");
  const Eigen::Quaterniond level = Eigen::Quaterniond::FromTwoVectors(upOf(recorded), space.up());

  Pose best = Pose::Identity();
  double best_score = -std::numeric_limits<double>::max();
  int found = 0;
  for (int i = 0; i < kPlacements && found < kJudged; ++i) {
    const StampedPose& anchor = motion[rng.below(static_cast<int>(motion.size()))];
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(rng.uniform(0, 6.2831853), space.up()) * level;
    const Pose place =
        Eigen::Translation3d(space.randomCell(rng) - rotation * anchor.world_from_camera.translation()) *
        rotation * Pose::Identity();
    const auto at = [&](std::size_t k) -> Eigen::Vector3d {
      return place * motion[k].world_from_camera.translation();
    };
    bool clear = true;
    for (std::size_t k = 0; k < motion.size() && clear; k += 8) clear = space.isClear(at(k), kPathClearance);
    for (std::size_t k = 0; k + 1 < motion.size() && clear; ++k)
      clear = space.isSegmentClear(at(k), at(k + 1), kPathClearance);
    if (!clear) continue;
    ++found;
    double score = 0;
    for (std::size_t k = 0; k < motion.size(); k += std::max<std::size_t>(1, motion.size() / 20)) {
      const ViewQuality view = judgeView(space.tracer(), options.intrinsics,
                                         place * motion[k].world_from_camera, options.max_depth);
      score += view.score() - (view.isAcceptable() ? 0 : 1);
    }
    if (score > best_score) best_score = score, best = place;
  }
  if (found == 0) {
    Eigen::Vector3d low = motion[0].world_from_camera.translation(), high = low;
    for (const StampedPose& p : motion) {
      low = low.cwiseMin(p.world_from_camera.translation());
      high = high.cwiseMax(p.world_from_camera.translation());
    }
    TextStream text;
    text.precision(2);
    text << options.replay_file.string() << ": the recorded motion spans " << high.x() - low.x() << " x "
         << high.y() - low.y() << " x " << high.z() - low.z()
         << " m and fits nowhere into the scene; give a larger mesh, another seed, or fewer --frames.";
    throw InputError(text.str());
  }
  for (StampedPose& p : motion) p.world_from_camera = best * p.world_from_camera;
  return motion;
}

}  // namespace rosefusion
