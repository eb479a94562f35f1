#include "host/loops/loop_closer.h"

#include <utility>

#include "host/frame_fuser.h"
#include "host/locate.h"
#include "host/loops/keyframe_map.h"
#include "host/loops/keyframe_store.h"

namespace rosefusion {
namespace {

// Travelled until the next comparison: after one that found the camera where it was thought, and after one
// that found nothing.
constexpr double kAfterAgreement = 1, kAfterNothing = 0.3;
// Two keyframes, not far apart, must ask for the same correction, to this and a share of it.
constexpr double kSameShift = 0.03, kSameTurn = 0.02, kSameShare = 0.1;
constexpr double kPendingFor = 1;  // travelled between the two
// A correction this large that is asked for no longer: the tracker has jumped onto the old map by itself.
// Ties to both sides of the jump hold only where the way between is loose; elsewhere they contradict it.
constexpr double kJump = 0.1;
constexpr double kConstraintFactor = 5;  // of refine.least_constraint: what holds a tie in every direction

/// What a measured pose asks for: a transform of the world.
struct Correction {
  Pose new_from_old_world;
  Pose camera;  ///< before it

  double shift() const { return (new_from_old_world * camera.translation() - camera.translation()).norm(); }
  double turn() const { return rotationAngle(new_from_old_world); }
  bool agreesWith(const Correction& other) const {
    const Eigen::Vector3d here = camera.translation();
    const double apart = (new_from_old_world * here - other.new_from_old_world * here).norm();
    const double turned = rotationAngle(new_from_old_world.inverse() * other.new_from_old_world);
    return apart < kSameShift + kSameShare * shift() && turned < kSameTurn + kSameShare * turn();
  }
};

class KeyframeLoopCloser : public LoopCloser {
 public:
  KeyframeLoopCloser(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                     double depth_units_per_metre, const TemplateSet& templates)
      : settings_(settings),
        map_(settings.loops),
        store_(settings.loops.memory_mb << 20),
        recorder_(device),
        fuser_(device, settings, intrinsics, depth_units_per_metre),
        search_(device, settings, intrinsics, templates),
        refiner_(device, settings, intrinsics),
        small_(device, {static_cast<float>(settings.volume.voxel_size),
                        static_cast<float>(settings.volume.truncation),
                        static_cast<float>(settings.volume.max_weight)}) {}

  std::optional<LoopClosure> add(const Frame& frame, const PreprocessPass& on_device, const Pose& pose,
                                 bool fused, bool firm) override {
    if (!map_.add(pose, fused, firm)) return {};
    store_.add(frame, map_.travelled());
    if (map_.travelled() < next_check_) return {};
    const auto old = map_.candidate([this](std::size_t i) { return store_.has(i); });
    if (!old) return {};
    ++figures_.checks;
    const std::optional<Pose> found = measure(*old, on_device, pose);
    if (!found) {
      next_check_ = map_.travelled() + kAfterNothing;
      return {};
    }
    const PoseEdge tie = map_.tieOf(*old, *found);
    const Correction correction{*found * pose.inverse(), pose};
    const bool agrees =
        correction.shift() < settings_.loops.tolerance && correction.turn() < settings_.loops.tolerance;
    const auto pendingWithin = [&](double most) {
      return pending_ && map_.travelled() - pending_->travelled < most;
    };
    if (agrees) {
      ++figures_.agreements;
      next_check_ = map_.travelled() + kAfterAgreement;
      if (!pendingWithin(settings_.loops.min_travel) || pending_->correction.shift() < kJump) {
        map_.tie(tie);
        pending_.reset();
        return {};
      }
    } else if (!pendingWithin(kPendingFor) || !correction.agreesWith(pending_->correction)) {
      pending_ = Pending{correction, tie, map_.travelled()};
      return {};
    }
    map_.tie(pending_->tie);
    map_.tie(tie);
    const Correction closed = std::exchange(pending_, {})->correction;
    if (!map_.close()) {
      ++figures_.contradictions;
      next_check_ = map_.travelled() + kAfterAgreement;
      return {};
    }
    ++figures_.closures;
    modelled_.reset();
    return LoopClosure{store_.timestamp(*old), closed.shift(), closed.turn()};
  }

  void breakOff() override {
    map_.breakOff();
    pending_.reset();  // no way from there is left that could contradict it
  }

  bool finish() override {
    if (figures_.closures == 0) return false;
    const std::vector<Pose> before = keyframePoses();
    if (!map_.close()) return false;
    for (std::size_t i = 0; i < before.size(); ++i)
      if ((map_.pose(i).translation() - before[i].translation()).norm() > settings_.loops.tolerance)
        return true;
    return false;
  }

  void rebuild(Volume& volume) override {
    volume.clear();
    for (std::size_t i = 0; i < store_.size(); ++i)
      if (store_.has(i)) fuse(i, volume);
  }

  std::vector<Pose> framePoses() const override { return map_.framePoses(); }

  std::vector<Pose> keyframePoses() const override {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < map_.size(); ++i) poses.push_back(map_.pose(i));
    return poses;
  }

  LoopFigures figures() const override {
    LoopFigures out = figures_;
    out.keyframes = store_.size();
    for (std::size_t i = 0; i < store_.size(); ++i) out.keyframes_with_images += store_.has(i);
    out.image_bytes = store_.bytes();
    return out;
  }

 private:
  struct Pending {
    Correction correction;
    PoseEdge tie;
    double travelled;
  };

  void fuse(std::size_t keyframe, Volume& volume) {
    fuser_.recordFrame(recorder_, store_.frame(keyframe));
    recorder_.submit();
    fuser_.fuse(recorder_, volume, map_.pose(keyframe));
  }

  bool confirms(const PoseFit& fit) const {
    return fit.holds(settings_.loops.share, kConstraintFactor * settings_.refine.least_constraint);
  }

  /// Pose of the frame in the map, from the old keyframe's surroundings alone; none where it does not fit.
  std::optional<Pose> measure(std::size_t old, const PreprocessPass& frame, const Pose& estimate) {
    if (modelled_ != old) {
      small_.clear();
      for (const std::size_t i : map_.neighbours(old, [this](std::size_t k) { return store_.has(k); }))
        fuse(i, small_);
      modelled_ = old;
    }
    const auto descend = [&](const Pose& start) {
      refiner_.look(frame, settings_.refine.pixel_stride);
      return refiner_.refine(small_, std::vector<Pose>{start}, settings_.refine.iterations, start)[0];
    };
    PoseFit fit = descend(estimate);
    if (!confirms(fit))
      fit = descend(locate(search_, refiner_, settings_.refine, frame, small_, std::vector<Pose>{estimate})
                        .world_from_camera);
    if (!confirms(fit)) return {};
    return fit.world_from_camera;
  }

  const Settings settings_;
  KeyframeMap map_;
  KeyframeStore store_;
  Recorder recorder_;
  FrameFuser fuser_;
  SwarmSearch search_;
  Refiner refiner_;
  Volume small_;  ///< around the old keyframe modelled_
  std::optional<std::size_t> modelled_;
  std::optional<Pending> pending_;
  double next_check_ = 0;  ///< travelled until then
  LoopFigures figures_;
};

}  // namespace

std::unique_ptr<LoopCloser> makeLoopCloser(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, double depth_units_per_metre,
                                           const TemplateSet& templates) {
  return std::make_unique<KeyframeLoopCloser>(device, settings, intrinsics, depth_units_per_metre, templates);
}

}  // namespace rosefusion
