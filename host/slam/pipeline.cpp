#include "host/slam/pipeline.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/passes/sum_check.h"
#include "host/core/error.h"
#include "host/settings/automatic.h"
#include "host/slam/baselines/pose_methods.h"
#include "host/slam/device_sums.h"
#include "host/slam/mapping/depth_holes.h"

namespace rosefusion {
namespace {

/// Adds the time from its construction to its end.
class StageTimer {
 public:
  explicit StageTimer(double& milliseconds) : milliseconds_(milliseconds) {}
  ~StageTimer() { milliseconds_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& milliseconds_;
  Clock::time_point start_ = Clock::now();
};

TemplateSet templatesFor(const Settings& s, const Log& log) {
  TemplateOptions options;
  options.sizes.clear();
  for (const SwarmLevel& level : s.swarm.levels) options.sizes.push_back(level.particles);
  options.count = s.tracking.templates_per_level;
  options.seed = s.tracking.seed;
  const auto say_once = [&](int done, int) {
    if (done == 1 && log)
      log(Severity::Info, "generating the swarm templates, once for this user and these sizes: some 10 s");
  };
  return loadOrGenerate(defaultTemplateCache(options), options, say_once, log);
}

/// The status that the numbers speak for, and why.
void judge(const TrackingSettings& limits, FrameResult& result) {
  const PoseScore& score = result.score;
  result.status = TrackingStatus::Tracked;
  if (score.valid_share < limits.min_valid_share) {
    result.status = TrackingStatus::Lost;
    result.reason = {Reason::LittleDepth, score.valid_share};
  } else if (score.overlap == 0) {
    result.status = TrackingStatus::Lost;
    result.reason = {Reason::NoOverlap};
  } else if (score.residual > limits.lost_residual) {
    result.status = TrackingStatus::Lost;
    result.reason = {Reason::PoorFit, score.residual};
  } else if (score.overlap < limits.uncertain_overlap) {
    result.status = TrackingStatus::Uncertain;
    result.reason = {Reason::LittleOverlap, score.overlap};
  } else if (score.residual > limits.uncertain_residual) {
    result.status = TrackingStatus::Uncertain;
    result.reason = {Reason::PoorFit, score.residual};
  }
}

// The noise of colours feigns slopes: worked out for a model of one image of a white wall, 3 m away, it seems
// to hold the pose by 4 times refine.least_constraint.
constexpr double kColourConstraint = 5;

/// A pose whose depth leaves a direction open is held there by the motion model, and may drift.
void judgeConstraint(const RefineSettings& limits, FrameResult& result) {
  if (!result.fit || result.status != TrackingStatus::Tracked) return;
  const double factor = result.fit->colour_cost > 0 ? kColourConstraint : kWeakConstraint;
  if (result.fit->observability >= factor * limits.least_constraint) return;
  result.status = TrackingStatus::Uncertain;
  result.reason = {result.fit->observability < limits.least_constraint ? Reason::Unconstrained
                                                                       : Reason::WeaklyConstrained};
}

}  // namespace

const char* toString(TrackingStatus status) {
  return status == TrackingStatus::Tracked       ? "tracked"
         : status == TrackingStatus::Uncertain   ? "uncertain"
         : status == TrackingStatus::Relocalised ? "relocalised"
                                                 : "lost";
}

Pipeline::Pipeline(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                   double depth_units_per_metre, const Log& log)
    : device_(device),
      settings_((requireConsistent(settings), requireImagesFit(settings, intrinsics.width, intrinsics.height),
                 resolved(settings))),
      intrinsics_(intrinsics),
      depth_units_per_metre_(depth_units_per_metre),
      recorder_(device),
      volume_(device, volumeOptions(settings_.volume)),
      fuser_(device, settings_, intrinsics, depth_units_per_metre),
      tracker_(device, settings_, intrinsics, templatesFor(settings_, log)),
      relocaliser_(settings_, tracker_),
      free_space_(intrinsics, settings_.depth, depth_units_per_metre),
      coarse_map_(device, settings_, intrinsics, depth_units_per_metre) {
  tracker_.replaceBy(
      makePoseMethod(device, settings_, intrinsics, tracker_.swarmSearch(), tracker_.refiner()));
  const std::filesystem::path cache = defaultTemplateCache({}).parent_path();
  sumsAreExact(
      cache.empty() ? cache : cache / "compensated_sums.txt", device.info(),
      [&] { return compensatedSumsWork(device); }, log);
  if (settings.loops.enabled)
    loops_ = makeLoopCloser(device, settings_, intrinsics, depth_units_per_metre, tracker_.templates());
}

void Pipeline::changeLive(const Settings& settings) {
  Settings changed = settings_;
  for (const SettingsField& field : settingsTable())
    if (isLiveSetting(field.key)) setField(changed, field.key, fieldText(settings, field), "a live change");
  requireConsistent(changed);
  settings_ = changed;
}

FrameResult Pipeline::processFrame(const Frame& frame) {
  FrameResult result = follow(frame);
  weighStart(frame, result);
  return result;
}

void Pipeline::clear() {
  volume_.clear();
  tracker_.reset();
  relocaliser_.rebase({});
  free_space_ = KnownFreeSpace(intrinsics_, settings_.depth, depth_units_per_metre_);
  coarse_map_.clear();
  coarse_map_stale_ = false;
  if (loops_)
    loops_ = makeLoopCloser(device_, settings_, intrinsics_, depth_units_per_metre_, tracker_.templates());
  frames_with_pose_ = 0;
  started_ = intruded_ = false;
  inlier_statistics_ = {};
  verification_.end();
  tentative_.reset();
}

void Pipeline::weighStart(const Frame& frame, FrameResult& result) {
  const double told = result.score.valid_share;
  const auto met = [&](const FrameResult& r) {
    return told * (r.fit ? r.fit->inlier_ratio : 1 - r.score.residual);
  };
  if (result.fused && frames_with_pose_ == 1) return start_.begin(frame, told);
  if (result.fused) return start_.confirm(met(result));
  if (result.status != TrackingStatus::Lost) return;
  const std::optional<ModelStart::Candidate> rival = start_.rival(frame, told);
  if (!rival) return;
  const ModelStart::Candidate first = *start_.first();
  const auto beginWith = [&](const ModelStart::Candidate& candidate) {
    clear();
    follow(candidate.frame);
    start_.begin(candidate.frame, candidate.told);
  };
  beginWith(*rival);
  FrameResult again = follow(frame);
  again.milliseconds.total += result.milliseconds.total;
  again.began_anew = true;
  if (again.status != TrackingStatus::Lost) {
    if (again.fused) start_.confirm(met(again));
    result = again;
    return;
  }
  if (rival->told > first.told) {
    result = again;
  } else {  // neither fits it: the first one stays
    beginWith(first);
    tracker_.setLost();
  }
  start_.rival(frame, told);
}

FrameResult Pipeline::follow(const Frame& frame) {
  FrameResult result;
  result.timestamp = frame.timestamp;
  const StageTimer total(result.milliseconds.total);
  {
    const StageTimer timer(result.milliseconds.preprocess);
    fuser_.recordFrame(recorder_, frame);
    recorder_.submit();
    host_depth_ = hostDepth(frame.depth);
  }
  tracker_.addOdometry(frame.motion);
  {
    const StageTimer timer(result.milliseconds.track);
    track(result);
  }
  if (result.status == TrackingStatus::Lost) {
    intruded_ = false;
    if (tentative_)
      tracker_.setTentative(*tentative_, result.timestamp);
    else if (started_)
      tracker_.setLost();
    if (loops_) loops_->onTrackingLost();
    return result;
  }
  result.fused = result.status != TrackingStatus::Relocalised && !intruded_;
  if (result.fused) {
    const StageTimer timer(result.milliseconds.integrate);
    fuser_.fuse(recorder_, volume_, result.world_from_camera);
    free_space_.keep(host_depth_, result.world_from_camera, frames_with_pose_);
    if (result.fit) inlier_statistics_.add(*result.fit);
    started_ = true;
  }
  if (result.status == TrackingStatus::Relocalised) {
    tracker_.setTentative(result.world_from_camera, result.timestamp);
  } else {
    tracker_.accept(result.world_from_camera, result.timestamp);
    if (result.fused && becomesKeyframe(result.world_from_camera))
      coarse_map_.add(fuser_, recorder_, host_depth_, result.world_from_camera, frames_with_pose_);
  }
  ++frames_with_pose_;
  if (loops_) closeLoops(frame, result);
  return result;
}

cv::Mat Pipeline::hostDepth(const cv::Mat& depth) const {
  return settings_.depth.footprint ? withSmallHolesFilled(depth) : depth;
}

void Pipeline::closeLoops(const Frame& frame, FrameResult& result) {
  const StageTimer timer(result.milliseconds.loops);
  result.loop = loops_->add(frame, fuser_.frame(), result.world_from_camera, result.fused,
                            result.status == TrackingStatus::Tracked);
  if (!result.loop) return;
  loops_->rebuild(volume_);
  const std::vector<Pose> poses = loops_->framePoses();
  result.world_from_camera = poses.back();
  tracker_.rebase(result.world_from_camera);
  relocaliser_.rebase(loops_->keyframePoses());
  coarse_map_.rebase(poses);
  coarse_map_stale_ = true;
  free_space_.rebase(poses);
}

bool Pipeline::becomesKeyframe(const Pose& world_from_camera) {
  return !tracker_.isReplaced() && relocaliser_.addKeyframe(world_from_camera);
}

void Pipeline::finish() {
  if (loops_ && loops_->finish()) loops_->rebuild(volume_);
}

/// What came before the camera is gone when the image shows the model again; that it is no longer where the
/// last fused frame looked is not enough.
bool Pipeline::isIntruded(const FrameResult& result) {
  if (result.intruding > settings_.tracking.intruding_share) return true;
  return intruded_ &&
         !(result.fit && result.intruding <= kIntrudingWhenFound * settings_.tracking.intruding_share &&
           result.fit->holds(settings_.tracking.relocalised_share, settings_.refine.least_constraint));
}

void Pipeline::verify(const TrackResult& found, bool unsure, FrameResult& result) {
  using Standing = TemporalVerification::Standing;
  const bool relocalising = tracker_.isLost() || verification_.isPending();
  const std::optional<VerifiedPose> verified =
      verifyPose(settings_, free_space_, host_depth_, found, unsure,
                 inlier_statistics_.thresholds(relocalising, settings_.tracking.intruding_share));
  if (verified) result.fit = verified->fit;
  result.intruding = free_space_.violation(host_depth_, result.fit->world_from_camera);
  const Standing standing =
      verification_.next(verified, settings_.tracking.relocalised_share, unsure, tracker_.isLost());
  if (standing == Standing::Rejected) {
    result.status = TrackingStatus::Lost;
    result.reason = {Reason::NotVerified};
    return;
  }
  if (standing == Standing::Tentative) {
    tentative_ = result.fit->world_from_camera;
    result.status = TrackingStatus::Lost;
    result.reason = {Reason::Tentative};
    return;
  }
  result.world_from_camera = result.fit->world_from_camera;
  result.score = tracker_.score(fuser_.frame(), volume_, result.world_from_camera);
  if (standing == Standing::Consistent) {
    result.status = TrackingStatus::Relocalised;
    result.reason = {unsure                       ? Reason::Jump
                     : verification_.hasOverlap() ? Reason::ConsistentOnce
                                                  : Reason::ConsistentUnknown};
    return;
  }
  result.status = TrackingStatus::Tracked;
  judgeConstraint(settings_.refine, result);
}

void Pipeline::track(FrameResult& result) {
  tentative_.reset();
  result.world_from_camera = tracker_.last();
  result.score = tracker_.score(fuser_.frame(), volume_, tracker_.last());
  if (!started_) {
    result.score.residual = 0;  // there is no model yet to differ from
    judge(settings_.tracking, result);
    return;
  }
  if (result.score.valid_share < settings_.tracking.min_valid_share) return judge(settings_.tracking, result);
  if (tracker_.isLost() && std::exchange(coarse_map_stale_, false)) loops_->rebuild(coarse_map_.volume());
  const TrackResult found = tracker_.isLost() ? relocaliser_.find(fuser_.frame(), host_depth_, volume_,
                                                                  coarse_map_, free_space_, result.timestamp)
                                              : tracker_.track(fuser_.frame(), volume_, result.timestamp);
  result.iterations = found.iterations;
  result.lookups = found.lookups;
  result.fit = found.fit;
  const bool unsure = tracker_.isLost() || found.jump;
  if (unsure || verification_.isPending()) return verify(found, unsure, result);
  result.score = tracker_.score(fuser_.frame(), volume_, found.world_from_camera);
  judge(settings_.tracking, result);
  judgeConstraint(settings_.refine, result);
  if (result.status != TrackingStatus::Lost) {
    result.intruding = free_space_.violationOfLast(host_depth_, found.world_from_camera);
    intruded_ = isIntruded(result);
  }
  if (intruded_ && result.status != TrackingStatus::Lost) {
    const double share = kShareOfNext * settings_.tracking.relocalised_share;
    const bool held = result.fit && result.fit->holds(share, settings_.refine.least_constraint);
    result.status = held ? TrackingStatus::Uncertain : TrackingStatus::Lost;
    result.reason = {held ? Reason::Occluded : Reason::OccludedAndNotHeld, result.intruding};
  }
  if (result.status != TrackingStatus::Lost) result.world_from_camera = found.world_from_camera;
}

void Pipeline::fuseFrame(const Frame& frame, const Pose& world_from_camera) {
  requireFixedPoses();
  fuser_.recordFrame(recorder_, frame);
  recorder_.submit();
  fuser_.fuse(recorder_, volume_, world_from_camera);
  accept(world_from_camera, frame.timestamp, frame.depth);
}

FrameIntegrator Pipeline::makeFuser() {
  requireFixedPoses();
  return {device_, settings_, intrinsics_, depth_units_per_metre_};
}

void Pipeline::requireFixedPoses() const {
  if (loops_)
    throw InputError(
        "loops.enabled moves poses, and cannot be on where frames of known pose are fused; leave it off.");
}

void Pipeline::accept(const Pose& world_from_camera, double timestamp, const cv::Mat& depth) {
  host_depth_ = depth.empty() ? depth : hostDepth(depth);
  if (!depth.empty()) free_space_.keep(host_depth_, world_from_camera, frames_with_pose_);
  started_ = true;
  start_.settle();
  verification_.end();
  const std::size_t number = frames_with_pose_++;
  tracker_.accept(world_from_camera, timestamp);
  if (!becomesKeyframe(world_from_camera) || depth.empty()) return;
  fuser_.recordFrame(recorder_, Frame{timestamp, depth, {}, {}});
  recorder_.submit();
  coarse_map_.add(fuser_, recorder_, host_depth_, world_from_camera, number);
}

}  // namespace rosefusion
