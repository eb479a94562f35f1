#include "host/slam/pipeline.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/passes/sum_check.h"
#include "host/core/error.h"
#include "host/settings/automatic.h"
#include "host/slam/baselines/pose_methods.h"
#include "host/slam/device_sums.h"
#include "host/slam/mapping/depth_image.h"

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

}  // namespace

Pipeline::Pipeline(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                   double depth_units_per_metre, const Log& log)
    : device_(device),
      settings_((requireConsistent(settings), requireImagesFit(settings, intrinsics.width, intrinsics.height),
                 resolved(settings))),
      intrinsics_(intrinsics),
      depth_units_per_metre_(depth_units_per_metre),
      recorder_(device),
      fuser_(device, settings_, intrinsics, depth_units_per_metre),
      search_(device, settings_, intrinsics, templatesFor(settings_, log)),
      refiner_(device, settings_, intrinsics),
      method_(makePoseMethod(device, settings_, intrinsics, search_, refiner_)),
      relocaliser_(settings_.refine, search_, refiner_),
      map_(device, settings_, intrinsics) {
  fuser_.prepare(map_.volume);
  search_.prepare(map_.volume);
  refiner_.prepare(map_.volume);
  const std::filesystem::path cache = defaultTemplateCache({}).parent_path();
  sumsAreExact(
      cache.empty() ? cache : cache / "compensated_sums.txt", device.info(),
      [&] { return compensatedSumsWork(device); }, log);
  if (settings.loops.enabled)
    loops_ = makeLoopCloser(device, settings_, intrinsics, depth_units_per_metre, search_.templates());
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
  map_.clear();
  state_ = Initialising{};
  if (loops_)
    loops_ = makeLoopCloser(device_, settings_, intrinsics_, depth_units_per_metre_, search_.templates());
  inlier_statistics_ = {};
}

void Pipeline::weighStart(const Frame& frame, FrameResult& result) {
  const double told = result.score.valid_share;
  const auto met = [&](const FrameResult& r) {
    return told * (r.fit ? r.fit->inlier_ratio : 1 - r.score.residual);
  };
  if (result.fused && result.number == 0U) return start_.begin(frame, told);
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
    state_ = withoutPose(state_, thresholds());
  }
  start_.rival(frame, told);
}

FrameResult Pipeline::follow(const Frame& frame) {
  FrameResult result;
  result.timestamp = frame.timestamp;
  const StageTimer total(result.milliseconds.total);
  preprocess(frame, result);
  addOdometry(state_, frame.motion);
  const FrameEvidence evidence = examine(frame, result);
  Decision decision = decide(state_, evidence, thresholds());
  report(evidence, decision, result);
  if (decision.integrate) integrate(result);
  state_ = std::move(decision.next);
  if (decision.pose)
    closeLoops(frame, result);
  else if (loops_)
    loops_->onTrackingLost();
  return result;
}

void Pipeline::preprocess(const Frame& frame, FrameResult& result) {
  const StageTimer timer(result.milliseconds.preprocess);
  fuser_.recordFrame(recorder_, frame);
  recordScore(acceptedPose(state_));
  recorder_.start();
  metres_ = depthInMetres(frame.depth, settings_.depth, depth_units_per_metre_);  // meanwhile
  recorder_.finish();
}

void Pipeline::recordScore(const Pose& world_from_camera) {
  search_.recordScore(recorder_, fuser_.frame(), map_.volume, world_from_camera, historyOf(state_).last);
}

PoseScore Pipeline::scoreAt(const Pose& world_from_camera) {
  recordScore(world_from_camera);
  recorder_.submit();
  return search_.recordedScore();
}

FrameEvidence Pipeline::examine(const Frame& frame, FrameResult& result) {
  const StageTimer timer(result.milliseconds.track);
  FrameEvidence out{frame.timestamp, search_.recordedScore(), {}, {}, 0};
  if (std::holds_alternative<Initialising>(state_)) {
    out.score.residual = 0;  // there is no model yet to differ from
    return out;
  }
  const Thresholds limits = thresholds();
  if (out.score.valid_share < limits.min_valid_share) return out;
  const bool lost = std::holds_alternative<Lost>(state_);
  if (lost) map_.coarse.refresh([this](Volume& coarse) { loops_->rebuild(coarse); });
  const TrackHistory& history = historyOf(state_);
  out.found = lost ? relocaliser_.find(fuser_.frame(), metres_, map_, history, frame.timestamp, observer_)
                   : method_->track(fuser_.frame(), map_.volume, history, frame.timestamp, observer_);
  if (!mustVerify(state_, *out.found, frame.timestamp, limits)) {
    recordScore(out.found->world_from_camera);
    recorder_.start();
    const double violation =
        map_.free_space.violationOfLast(metres_, out.found->world_from_camera);  // meanwhile
    recorder_.finish();
    out.score = search_.recordedScore();
    if (judge(out.score, limits).status != TrackingStatus::Lost) out.violation = violation;
    return out;
  }
  const bool followed = std::holds_alternative<Tracking>(state_);
  out.verified = verifyPose(settings_, map_.free_space, metres_, *out.found,
                            isUnsure(state_, *out.found, frame.timestamp, limits),
                            inlier_statistics_.thresholds(!followed, limits.intruding_share));
  const PoseFit& fit = out.verified ? out.verified->fit : *out.found->fit;
  out.violation = map_.free_space.violation(metres_, fit.world_from_camera);
  return out;
}

void Pipeline::report(const FrameEvidence& evidence, const Decision& decision, FrameResult& result) {
  result.world_from_camera = decision.pose.value_or(acceptedPose(state_));
  result.status = decision.status;
  result.reason = decision.reason;
  result.fused = decision.integrate;
  if (!loops_) result.recovered = decision.recovered;  // what has no images closes no loop
  result.score = evidence.score;
  result.intruding = evidence.violation;
  if (!evidence.found) return;
  result.iterations = evidence.found->iterations;
  result.lookups = evidence.found->lookups;
  result.fit = evidence.verified ? evidence.verified->fit : evidence.found->fit;
  // That of the evidence is of the last pose where another one had to be verified.
  if (evidence.verified && decision.pose) result.score = scoreAt(*decision.pose);
}

void Pipeline::integrate(FrameResult& result) {
  const StageTimer timer(result.milliseconds.integrate);
  fuse(result.world_from_camera);
  if (result.fit) inlier_statistics_.add(*result.fit);
  map_.keyframes.setLast(metres_, result.world_from_camera, map_.trajectory.size());
}

/// Into the model last: what fails before can be tried again, and no frame is in it twice.
void Pipeline::fuse(const Pose& world_from_camera) {
  if (becomesKeyframe(world_from_camera)) map_.coarse.add(fuser_, recorder_, world_from_camera);
  fuser_.fuse(recorder_, map_.volume, world_from_camera);
}

void Pipeline::closeLoops(const Frame& frame, FrameResult& result) {
  map_.trajectory.insert(map_.trajectory.end(), result.recovered.begin(), result.recovered.end());
  result.number = map_.trajectory.size();
  map_.trajectory.push_back({result.timestamp, result.world_from_camera});
  if (!loops_) {
    result.stretch_closed = map_.open_stretches.add(
        map_.trajectory, result.fit ? result.fit->covariance : OpenStretches::Covariance::Zero());
    return;
  }
  const StageTimer timer(result.milliseconds.loops);
  result.loop = loops_->add(frame, metres_, fuser_.frame(), result.world_from_camera, result.fused,
                            result.status == TrackingStatus::Tracked);
  if (!result.loop) return;
  loops_->rebuild(map_.volume);
  map_.move(loops_->framePoses());
  result.world_from_camera = map_.trajectory.back().world_from_camera;
  move(state_, result.world_from_camera);
}

bool Pipeline::becomesKeyframe(const Pose& world_from_camera) {
  return method_->relocalises() && map_.keyframes.offer(metres_, world_from_camera, map_.trajectory.size());
}

void Pipeline::finish() {
  recorder_.finish();
  if (!loops_) return;
  const bool rebuild = loops_->finish();
  map_.move(loops_->framePoses());
  if (rebuild) loops_->rebuild(map_.volume);
}

void Pipeline::fuseFrame(const Frame& frame, const Pose& world_from_camera) {
  requireFixedPoses();
  fuser_.recordFrame(recorder_, frame);
  recorder_.submit();
  metres_ = depthInMetres(frame.depth, settings_.depth, depth_units_per_metre_);
  fuse(world_from_camera);
  goOnFrom(world_from_camera, frame.timestamp);
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
  metres_ = depth.empty() ? depth : depthInMetres(depth, settings_.depth, depth_units_per_metre_);
  if (becomesKeyframe(world_from_camera) && !depth.empty()) {
    fuser_.recordFrame(recorder_, Frame{timestamp, depth, {}, {}});
    recorder_.submit();
    map_.coarse.add(fuser_, recorder_, world_from_camera);
  }
  goOnFrom(world_from_camera, timestamp);
}

void Pipeline::goOnFrom(const Pose& world_from_camera, double timestamp) {
  start_.settle();
  state_ = accepted(state_, world_from_camera, timestamp);
  if (!metres_.empty()) map_.keyframes.setLast(metres_, world_from_camera, map_.trajectory.size());
  map_.trajectory.push_back({timestamp, world_from_camera});
}

}  // namespace rosefusion
