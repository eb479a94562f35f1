#include "host/slam/loop_closure/loop_closer.h"

#include <algorithm>
#include <utility>

#include "host/slam/loop_closure/keyframe_graph.h"
#include "host/slam/loop_closure/keyframe_images.h"
#include "host/slam/loop_closure/keyframe_views.h"
#include "host/slam/loop_closure/local_odometry.h"
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/relocalisation/pose_search.h"

namespace rosefusion {
namespace {

// Travelled until the next comparison: after one that found the camera where it was thought, and after one
// that found nothing.
constexpr double kAfterAgreement = 1, kAfterNothing = 0.3;
// Two keyframes, not far apart, must ask for the same correction, to this and a share of it.
constexpr double kSameShift = 0.03, kSameTurn = 0.02, kSameShare = 0.1;
constexpr double kPendingFor = 1;  // travelled between the two, of which one at least must be sure
// If a large correction is gone at the next check, tracking snapped onto the old surfaces by itself. Loop
// constraints on both sides of the snap are consistent only if the odometry between has inflated covariance.
constexpr double kJump = 0.08, kJumped = 0.25;  // metres; the share of it that may be left
constexpr double kLever = 2.5;                  // metres from the camera to what a turn moves
// A place that comes into view: at so much of loops.share a keyframe may speak for a correction, though not
// alone. Walls that are there twice lead the tracker astray soon after.
constexpr double kSuspicion = 0.5;
// Local odometry runs from the first small overlap with old surfaces until a comparison with them, for so
// long.
constexpr double kSmallOverlap = 0.05, kLongestSmallOverlap = 12;  // share of the image; travelled
constexpr double kSlide = 0.04;                                    // metres that it differs by
constexpr std::size_t kRecent = 8;                                 // keyframes that it begins with
constexpr double kConstraintFactor =
    5;  // of refine.least_constraint: what holds a loop constraint in every direction

VolumeOptions optionsOf(const VolumeSettings& s, bool colour) {
  VolumeOptions out = volumeOptions(s);
  out.colour = colour;
  out.memory_limit_bytes = 0;
  return out;
}

/// What a measured pose asks for: a transform of the world.
struct Correction {
  Pose new_from_old_world;
  Pose camera;  ///< before it

  /// What it does to what the camera sees.
  double size() const { return shift() + kLever * turn(); }
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
        graph_(settings.loops),
        images_(settings.loops.memory_mb << 20),
        views_(intrinsics),
        recorder_(device),
        fuser_(device, settings, intrinsics, depth_units_per_metre),
        search_(device, settings, intrinsics, templates),
        refiner_(device, settings, intrinsics),
        small_(device, optionsOf(settings.volume, false)),
        local_odometry_(device, settings, intrinsics, optionsOf(settings.volume, settings.volume.colour),
                        [this](std::size_t i, Volume& volume, const Pose& pose) {
                          if (images_.has(i)) fuse(i, volume, pose);
                        }) {}

  std::optional<LoopClosure> add(const Frame& frame, const cv::Mat& metres, const DeviceFrame& on_device,
                                 const Pose& pose, bool fused, bool well_constrained) override {
    if (!graph_.add(pose, fused, well_constrained)) return {};
    images_.add(frame, graph_.travelled());
    views_.add(metres);
    trackLocally(on_device);
    if (graph_.travelled() < next_check_) return {};
    const auto old = graph_.candidate(
        [this](std::size_t i) { return images_.has(i); },
        [&](std::size_t i) { return views_.overlap(graph_.size() - 1, i, graph_.pose(i).inverse() * pose); });
    if (!old) return {};
    ++figures_.checks;
    std::optional<Finding> found = measure(*old, on_device, pose);
    if (!found) return {};
    const std::optional<Correction> slide = slideOf(*found);
    if (slide) found->correction = *slide;
    if (!accept(*found)) return {};
    const bool closed = slide ? graph_.close(local_odometry_.poses()) : graph_.close();
    endRevisit();
    if (!closed) {
      ++figures_.contradictions;
      next_check_ = graph_.travelled() + kAfterAgreement;
      return {};
    }
    ++figures_.closures;
    modelled_.reset();
    suspected_.reset();
    return LoopClosure{images_.timestamp(*old), found->correction.shift(), found->correction.turn()};
  }

  void onTrackingLost() override {
    graph_.onTrackingLost();
    suspected_.reset();
    local_odometry_.end();
    revisit_checked_ = false;
    unbroken_from_ = graph_.size();
    pending_.reset();  // no way from there is left that could contradict it
  }

  bool finish() override {
    if (figures_.closures == 0) return false;
    const std::vector<Pose> before = keyframePoses();
    if (!graph_.close()) return false;
    for (std::size_t i = 0; i < before.size(); ++i)
      if ((graph_.pose(i).translation() - before[i].translation()).norm() > settings_.loops.tolerance)
        return true;
    return false;
  }

  void rebuild(Volume& volume) override {
    volume.clear();
    for (std::size_t i = 0; i < images_.size(); ++i)
      if (images_.has(i)) fuse(i, volume, graph_.pose(i));
  }

  std::vector<Pose> framePoses() const override { return graph_.framePoses(); }

  LoopFigures figures() const override {
    LoopFigures out = figures_;
    out.keyframes = images_.size();
    for (std::size_t i = 0; i < images_.size(); ++i) out.keyframes_with_images += images_.has(i);
    out.image_bytes = images_.bytes();
    return out;
  }

 private:
  std::vector<Pose> keyframePoses() const {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < graph_.size(); ++i) poses.push_back(graph_.pose(i));
    return poses;
  }

  /// What a comparison with an old place found.
  struct Finding {
    Correction correction;
    PoseEdge constraint;
    double travelled;
    bool sure;
  };

  /// True where the loop constraints, to which this was added, are to move the map now.
  bool accept(const Finding& found) {
    const Correction& c = found.correction;
    const auto pendingWithin = [&](double most) {
      return pending_ && found.travelled - pending_->travelled < most;
    };
    const bool again =
        pendingWithin(kPendingFor) && c.agreesWith(pending_->correction) && (found.sure || pending_->sure);
    const bool jumped = pendingWithin(settings_.loops.min_travel) && found.sure && pending_->sure &&
                        pending_->correction.size() > kJump &&
                        c.size() < kJumped * pending_->correction.size();
    if (again || jumped) {
      graph_.addConstraint(std::exchange(pending_, {})->constraint);
      graph_.addConstraint(found.constraint);
      return true;
    }
    if (isDrift(c)) {
      pending_ = found;
      return false;
    }
    next_check_ = found.travelled + (found.sure ? kAfterAgreement : kAfterNothing);
    if (!found.sure) return false;
    ++figures_.agreements;
    graph_.addConstraint(found.constraint);
    pending_.reset();
    endRevisit();
    return false;
  }

  /// Drift that shows on the way measured anew, and there alone.
  std::optional<Correction> slideOf(const Finding& found) const {
    if (local_odometry_.poses().empty() || !found.sure || isDrift(found.correction)) return {};
    const Pose& camera = local_odometry_.poses().back();
    const Correction& tracked = found.correction;
    const Correction slide{tracked.new_from_old_world * tracked.camera * camera.inverse(), camera};
    return slide.size() < kSlide ? std::nullopt : std::optional(slide);
  }

  bool isDrift(const Correction& c) const {
    return c.shift() >= settings_.loops.tolerance || c.turn() >= settings_.loops.tolerance;
  }

  /// From here on the old surfaces in view hold the camera.
  void endRevisit() {
    revisit_checked_ = true;
    local_odometry_.end();
  }

  /// Measures the newest keyframe's pose anew while there are old surfaces in view that it was not yet
  /// compared with.
  void trackLocally(const DeviceFrame& frame) {
    const std::size_t newest = graph_.size() - 1;
    const Pose& pose = graph_.pose(newest);
    const bool revisiting = graph_.overlapsOld(kSmallOverlap, [&](std::size_t i) {
      return views_.overlap(newest, i, graph_.pose(i).inverse() * pose);
    });
    if (!revisiting) revisit_checked_ = false;
    if (!revisiting || revisit_checked_ || newest <= unbroken_from_) return local_odometry_.end();
    if (local_odometry_.poses().empty()) {
      std::vector<Pose> recent;
      for (std::size_t i = std::max(unbroken_from_, newest - std::min(newest, kRecent)); i < newest; ++i)
        recent.push_back(graph_.pose(i));
      local_odometry_.begin(newest - recent.size(), recent);
      local_odometry_from_ = graph_.travelled();
    }
    if (graph_.travelled() - local_odometry_from_ > kLongestSmallOverlap) return endRevisit();
    local_odometry_.step(frame, graph_.pose(newest - 1).inverse() * pose);
  }

  void fuse(std::size_t keyframe, Volume& volume, const Pose& pose) {
    fuser_.recordFrame(recorder_, images_.frame(keyframe));
    recorder_.submit();
    fuser_.fuse(recorder_, volume, pose);
  }

  /// Pose of the frame in the map, from the old keyframe's surroundings alone; none where it does not fit.
  std::optional<Finding> measure(std::size_t old, const DeviceFrame& frame, const Pose& estimate) {
    if (modelled_ != old) {
      small_.clear();
      for (const std::size_t i : graph_.neighbours(old, [this](std::size_t k) { return images_.has(k); }))
        fuse(i, small_, graph_.pose(i));
      modelled_ = old;
    }
    std::vector<Pose> starts{estimate};
    if (suspected_) starts.push_back(suspected_->new_from_old_world * estimate);
    const auto holds = [&](const PoseFit& fit, double share) {
      return fit.holds(share, kConstraintFactor * settings_.refine.least_constraint);
    };
    const auto descend = [&](const std::vector<Pose>& from) {
      refiner_.selectPixels(frame, settings_.refine.pixel_stride);
      const std::vector<PoseFit> fits =
          refiner_.refine(small_, from, settings_.refine.iterations, from.back());
      return *std::min_element(fits.begin(), fits.end(),
                               [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; });
    };
    PoseFit fit = descend(starts);
    if (!holds(fit, settings_.loops.share))
      fit = descend(
          {searchAround(search_, refiner_, settings_.refine, frame, small_, starts).world_from_camera});
    suspected_.reset();
    if (!holds(fit, kSuspicion * settings_.loops.share)) {
      next_check_ = graph_.travelled() + kAfterNothing;
      return {};
    }
    const bool sure = holds(fit, settings_.loops.share);
    suspected_ = Correction{fit.world_from_camera * estimate.inverse(), estimate};
    return Finding{*suspected_, graph_.constraintTo(old, fit.world_from_camera, sure), graph_.travelled(),
                   sure};
  }

  const Settings settings_;
  KeyframeGraph graph_;
  KeyframeImages images_;
  KeyframeViews views_;
  Recorder recorder_;
  FrameIntegrator fuser_;
  SwarmSearch search_;
  PoseRefiner refiner_;
  Volume small_;  ///< around the old keyframe modelled_
  std::optional<std::size_t> modelled_;
  LocalOdometry local_odometry_;
  double local_odometry_from_ = 0;       ///< travelled until it began
  std::size_t unbroken_from_ = 0;        ///< keyframe after the last loss
  bool revisit_checked_ = false;         ///< the old surfaces in view have been compared with
  std::optional<Finding> pending_;       ///< drift that one keyframe told of
  std::optional<Correction> suspected_;  ///< what the last comparison found, which starts the next
  double next_check_ = 0;                ///< travelled until then
  LoopFigures figures_;
};

}  // namespace

std::unique_ptr<LoopCloser> makeLoopCloser(Device& device, const Settings& settings,
                                           const Intrinsics& intrinsics, double depth_units_per_metre,
                                           const TemplateSet& templates) {
  return std::make_unique<KeyframeLoopCloser>(device, settings, intrinsics, depth_units_per_metre, templates);
}

}  // namespace rosefusion
