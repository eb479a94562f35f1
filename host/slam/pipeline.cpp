#include "host/slam/pipeline.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/error.h"
#include "engine/passes/sum_check.h"
#include "host/core/error.h"
#include "host/settings/automatic.h"
#include "host/slam/baselines/pose_methods.h"
#include "host/slam/device_sums.h"
#include "host/slam/mapping/depth_image.h"
#include "host/slam/mapping/rolling_shutter.h"

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
      first_(device, settings_, intrinsics),
      detached_(detachedWork(), settings_.tracking.intruding_share) {
  fuser_.prepare(first_.map.volume);
  search_.prepare(first_.map.volume);
  refiner_.prepare(first_.map.volume);
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
  if (loops_ || !method_->relocalises()) return followAndWeigh(first_, frame);
  FrameResult result = detached_.asksFirst(first_) ? followInFirst(frame) : unasked(frame);
  detached_.add(first_, frame, result);
  return result;
}

FrameResult Pipeline::follow(Submap& at, const Frame& taken) {
  FrameResult result;
  result.timestamp = taken.timestamp;
  const StageTimer total(result.milliseconds.total);
  const auto [frame, readout] = atOnce(at, taken, result);
  preprocess(at, frame, result);
  addOdometry(at.state, frame.motion);
  const FrameEvidence evidence = examine(at, frame, result);
  Decision decision = decide(at.state, evidence, thresholds());
  report(at, evidence, decision, result);
  if (decision.integrate) integrate(at, result);
  if (result.fit && result.status == TrackingStatus::Tracked)
    readout_.add(result.fit->readout, readout, historyOf(at.state).motion.secondsSince(frame.timestamp));
  at.state = std::move(decision.next);
  if (decision.pose)
    addPose(at, frame, decision.recovered, result);
  else if (loops_)
    loops_->onTrackingLost();
  return result;
}

Pipeline::AtOnce Pipeline::atOnce(const Submap& at, const Frame& frame, FrameResult& result) const {
  const StageTimer timer(result.milliseconds.preprocess);
  const double readout = readoutSeconds();
  if (readout == 0 || std::holds_alternative<Lost>(at.state)) return {frame, 0};
  const std::optional<Velocity> velocity = historyOf(at.state).motion.velocity();
  if (!velocity) return {frame, 0};
  return {withoutRollingShutter(frame, intrinsics_, depth_units_per_metre_, readout, *velocity), readout};
}

double Pipeline::readoutSeconds() const {
  const DepthSettings& depth = settings_.depth;
  if (!depth.rolling_shutter) return 0;
  return depth.readout != 0 ? depth.readout : readout_.seconds();
}

void Pipeline::preprocess(const Submap& at, const Frame& frame, FrameResult& result) {
  const StageTimer timer(result.milliseconds.preprocess);
  fuser_.recordFrame(recorder_, frame);
  recordScore(at, acceptedPose(at.state));
  recorder_.start();
  metres_ = depthInMetres(frame.depth, settings_.depth, depth_units_per_metre_);  // meanwhile
  recorder_.finish();
}

FrameEvidence Pipeline::examine(Submap& at, const Frame& frame, FrameResult& result) {
  const StageTimer timer(result.milliseconds.track);
  FrameEvidence out{frame.timestamp, search_.recordedScore(), {}, {}, 0};
  if (std::holds_alternative<Initialising>(at.state)) {
    out.score.residual = 0;  // there is no model yet to differ from
    return out;
  }
  const Thresholds limits = thresholds();
  if (out.score.valid_share < limits.min_valid_share) return out;
  const bool lost = std::holds_alternative<Lost>(at.state);
  if (lost) at.map.coarse.refresh([this](Volume& coarse) { loops_->rebuild(coarse); });
  const TrackHistory& history = historyOf(at.state);
  out.found = lost ? relocaliser_.find(fuser_.frame(), metres_, at.map, history, frame.timestamp, observer_)
                   : method_->track(fuser_.frame(), at.map.volume, history, frame.timestamp, observer_);
  if (!mustVerify(at.state, *out.found, frame.timestamp, limits)) {
    recordScore(at, out.found->world_from_camera);
    recorder_.start();
    const double violation =
        at.map.free_space.violationOfLast(metres_, out.found->world_from_camera);  // meanwhile
    recorder_.finish();
    out.score = search_.recordedScore();
    if (judge(out.score, limits).status != TrackingStatus::Lost) out.violation = violation;
    return out;
  }
  const bool followed = std::holds_alternative<Tracking>(at.state);
  out.verified = verifyPose(settings_, at.map.free_space, metres_, *out.found,
                            isUnsure(at.state, *out.found, frame.timestamp, limits),
                            at.inlier_statistics.thresholds(!followed, limits.intruding_share));
  const PoseFit& fit = out.verified ? out.verified->fit : *out.found->fit;
  out.violation = at.map.free_space.violation(metres_, fit.world_from_camera);
  return out;
}

void Pipeline::recordScore(const Submap& at, const Pose& world_from_camera) {
  search_.recordScore(recorder_, fuser_.frame(), at.map.volume, world_from_camera, historyOf(at.state).last);
}

PoseScore Pipeline::scoreAt(const Submap& at, const Pose& world_from_camera) {
  recordScore(at, world_from_camera);
  recorder_.submit();
  return search_.recordedScore();
}

void Pipeline::report(const Submap& at, const FrameEvidence& evidence, const Decision& decision,
                      FrameResult& result) {
  result.world_from_camera = decision.pose.value_or(acceptedPose(at.state));
  result.status = decision.status;
  result.reason = decision.reason;
  result.fused = decision.integrate;
  result.score = evidence.score;
  result.intruding = evidence.violation;
  if (!evidence.found) return;
  result.iterations = evidence.found->iterations;
  result.lookups = evidence.found->lookups;
  result.fit = evidence.verified ? evidence.verified->fit : evidence.found->fit;
  // That of the evidence is of the last pose where another one had to be verified.
  if (evidence.verified && decision.pose) result.score = scoreAt(at, *decision.pose);
}

void Pipeline::integrate(Submap& at, FrameResult& result) {
  const StageTimer timer(result.milliseconds.integrate);
  fuse(at, result.world_from_camera, at.map.trajectory.size());
  if (result.fit) at.inlier_statistics.add(*result.fit);
  at.map.keyframes.setLast(metres_, result.world_from_camera, at.map.trajectory.size());
}

/// Into the model last: what fails before can be tried again, and no frame is in it twice.
void Pipeline::fuse(Submap& at, const Pose& world_from_camera, std::size_t number) {
  if (becomesKeyframe(at, world_from_camera, number)) at.map.coarse.add(fuser_, recorder_, world_from_camera);
  fuser_.fuse(recorder_, at.map.volume, world_from_camera);
}

bool Pipeline::becomesKeyframe(Submap& at, const Pose& world_from_camera, std::size_t number) {
  return method_->relocalises() && at.map.keyframes.offer(metres_, world_from_camera, number);
}

void Pipeline::addPose(Submap& at, const Frame& frame, const Trajectory& recovered, FrameResult& result) {
  Map& map = at.map;
  if (!loops_) {  // what has no images closes no loop
    for (const StampedPose& pose : recovered) {
      result.recovered.push_back({map.trajectory.size(), pose, Reason::ConfirmedLater});
      map.trajectory.push_back(pose);
    }
  }
  result.number = map.trajectory.size();
  map.trajectory.push_back({result.timestamp, result.world_from_camera});
  if (!loops_) {
    result.stretch_closed = map.open_stretches.add(
        map.trajectory, result.fit ? result.fit->covariance : OpenStretches::Covariance::Zero());
    return;
  }
  const StageTimer timer(result.milliseconds.loops);
  result.loop = loops_->add(frame, metres_, fuser_.frame(), result.world_from_camera, result.fused,
                            result.status == TrackingStatus::Tracked);
  if (!result.loop) return;
  loops_->rebuild(map.volume);
  map.move(loops_->framePoses());
  result.world_from_camera = map.trajectory.back().world_from_camera;
  move(at.state, result.world_from_camera);
}

FrameResult Pipeline::followInFirst(const Frame& frame) {
  if (detached_.all().empty()) return followAndWeigh(first_, frame);
  const TrackingState before = first_.state;
  try {
    return followAndWeigh(first_, frame);
  } catch (const DeviceError& error) {
    if (error.code() != DeviceErrorCode::OutOfMemory) throw;
    detached_.giveUp();
    first_.state = before;
    return followAndWeigh(first_, frame);
  }
}

FrameResult Pipeline::unasked(const Frame& frame) {
  addOdometry(first_.state, frame.motion);
  FrameResult result;
  result.timestamp = frame.timestamp;
  result.world_from_camera = acceptedPose(first_.state);
  result.reason = {Reason::NotVerified};
  return result;
}

FrameResult Pipeline::followAndWeigh(Submap& at, const Frame& frame) {
  FrameResult result = follow(at, frame);
  weighStart(at, frame, result);
  return result;
}

void Pipeline::weighStart(Submap& at, const Frame& frame, FrameResult& result) {
  const double told = result.score.valid_share;
  const auto met = [&](const FrameResult& r) {
    return told * (r.fit ? r.fit->inlier_ratio : 1 - r.score.residual);
  };
  if (result.fused && result.number == 0U) return at.start.begin(frame, told);
  if (result.fused) return at.start.confirm(met(result));
  if (result.status != TrackingStatus::Lost) return;
  const std::optional<ModelStart::Candidate> rival = at.start.rival(frame, told);
  if (!rival) return;
  const ModelStart::Candidate first = *at.start.first();
  const Trajectory told_poses = at.map.trajectory;
  const auto beginWith = [&](const ModelStart::Candidate& candidate) {
    clear(at);
    follow(at, candidate.frame);
    at.start.begin(candidate.frame, candidate.told);
  };
  beginWith(*rival);
  FrameResult again = follow(at, frame);
  again.milliseconds.total += result.milliseconds.total;
  again.began_anew = true;
  if (again.status != TrackingStatus::Lost) {
    if (again.fused) at.start.confirm(met(again));
    result = again;
    return;
  }
  if (rival->told > first.told) {
    result = again;
  } else {  // neither fits it: the first one stays
    beginWith(first);
    at.map.trajectory = told_poses;  // their numbers are out
    at.state = withoutPose(at.state, thresholds());
  }
  at.start.rival(frame, told);
}

void Pipeline::clear(Submap& at) {
  at.map.clear();
  at.state = Initialising{};
  at.inlier_statistics = {};
  if (loops_)
    loops_ = makeLoopCloser(device_, settings_, intrinsics_, depth_units_per_metre_, search_.templates());
}

DetachedMaps::Work Pipeline::detachedWork() {
  return {[this](std::size_t number) {
            return std::make_unique<DetachedMap>(device_, settings_, intrinsics_, number);
          },
          [this](Submap& at, const Frame& frame) { return followAndWeigh(at, frame); },
          [this](Submap& at, const Frame& frame, const Pose& world_from_camera, std::size_t number) {
            load(frame);
            fuse(at, world_from_camera, number);
          },
          [this](Submap& at, const Frame& frame, const Pose& world_from_camera) {
            return at.map.free_space.violation(
                depthInMetres(frame.depth, settings_.depth, depth_units_per_metre_), world_from_camera);
          }};
}

void Pipeline::load(const Frame& frame) {
  fuser_.recordFrame(recorder_, frame);
  recorder_.submit();
  metres_ = depthInMetres(frame.depth, settings_.depth, depth_units_per_metre_);
}

void Pipeline::finish() {
  recorder_.finish();
  if (!loops_) return;
  const bool rebuild = loops_->finish();
  first_.map.move(loops_->framePoses());
  if (rebuild) loops_->rebuild(first_.map.volume);
}

void Pipeline::fuseFrame(const Frame& frame, const Pose& world_from_camera) {
  requireFixedPoses();
  load(frame);
  fuse(first_, world_from_camera, first_.map.trajectory.size());
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
  if (becomesKeyframe(first_, world_from_camera, first_.map.trajectory.size()) && !depth.empty()) {
    fuser_.recordFrame(recorder_, Frame{timestamp, depth, {}, {}});
    recorder_.submit();
    first_.map.coarse.add(fuser_, recorder_, world_from_camera);
  }
  goOnFrom(world_from_camera, timestamp);
}

void Pipeline::goOnFrom(const Pose& world_from_camera, double timestamp) {
  Map& map = first_.map;
  first_.start.settle();
  first_.state = accepted(first_.state, world_from_camera, timestamp);
  if (!metres_.empty()) map.keyframes.setLast(metres_, world_from_camera, map.trajectory.size());
  map.trajectory.push_back({timestamp, world_from_camera});
}

}  // namespace rosefusion
