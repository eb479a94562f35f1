#include "host/pipeline.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>

#include "host/error.h"
#include "host/shader_types.h"

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

VolumeOptions volumeOptions(const Settings& s) {
  return {static_cast<float>(s.volume.voxel_size), static_cast<float>(s.volume.truncation),
          static_cast<float>(s.volume.max_weight), s.volume.colour, s.volume.memory_limit_mb << 20};
}

TemplateSet templatesFor(const Settings& s) {
  TemplateOptions options;
  options.sizes.clear();
  for (const SwarmLevel& level : s.swarm.levels) options.sizes.push_back(level.particles);
  options.count = s.tracking.templates_per_level;
  options.seed = s.tracking.seed;
  const auto say_once = [](int done, int) {
    if (done == 1)
      spdlog::info("generating the swarm templates, once for this user and these sizes: some 10 s");
  };
  return loadOrGenerate(defaultTemplateCache(options), options, say_once);
}

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

/// The status that the numbers speak for, and why.
void judge(const TrackingSettings& limits, FrameResult& result) {
  const PoseScore& score = result.score;
  result.status = TrackingStatus::Tracked;
  if (score.valid_share < limits.min_valid_share) {
    result.status = TrackingStatus::Lost;
    result.reason = "only " + percent(score.valid_share) + " of the pixels have valid depth";
  } else if (score.overlap == 0) {
    result.status = TrackingStatus::Lost;
    result.reason = "no pixel overlaps the last frame";
  } else if (score.residual > limits.lost_residual) {
    result.status = TrackingStatus::Lost;
    result.reason = "the depth misses the model by " + percent(score.residual) + " of the truncation";
  } else if (score.overlap < limits.uncertain_overlap) {
    result.status = TrackingStatus::Uncertain;
    result.reason = "only " + percent(score.overlap) + " of the pixels overlap the last frame";
  } else if (score.residual > limits.uncertain_residual) {
    result.status = TrackingStatus::Uncertain;
    result.reason = "the depth misses the model by " + percent(score.residual) + " of the truncation";
  }
}

constexpr double kCloseAmongUsable = 0.75;
constexpr int kConfirmations = 2;  // frames after the one that was found again

/// Whether a pose that was searched in the whole model may be believed: most of the image must lie on it.
bool confirms(const TrackingSettings& limits, const PoseFit& fit) {
  return fit.usable >= limits.relocalised_share && fit.close >= kCloseAmongUsable * fit.usable;
}

/// A pose whose depth leaves a direction open is held there by the motion model, and may drift.
void judgeConstraint(const RefineSettings& limits, FrameResult& result) {
  if (!result.fit || result.status != TrackingStatus::Tracked) return;
  if (result.fit->constraint >= limits.least_constraint) return;
  result.status = TrackingStatus::Uncertain;
  result.reason = "the depth leaves a direction open, as a flat wall does; past motion holds it";
}

std::vector<std::uint32_t> packColour(const cv::Mat& bgr) {
  std::vector<std::uint32_t> rgb;
  rgb.reserve(bgr.total());
  for (int row = 0; row < bgr.rows; ++row)
    for (int column = 0; column < bgr.cols; ++column) {
      const auto& p = bgr.at<cv::Vec3b>(row, column);
      rgb.push_back(p[2] | p[1] << 8 | p[0] << 16);
    }
  return rgb;
}

}  // namespace

const char* toString(TrackingStatus status) {
  return status == TrackingStatus::Tracked       ? "tracked"
         : status == TrackingStatus::Uncertain   ? "uncertain"
         : status == TrackingStatus::Relocalised ? "relocalised"
                                                 : "lost";
}

Pipeline::Pipeline(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                   double depth_units_per_metre)
    : device_(device),
      settings_((requireConsistent(settings), settings)),
      intrinsics_(intrinsics),
      depth_units_per_metre_(depth_units_per_metre),
      recorder_(device),
      volume_(device, volumeOptions(settings)),
      preprocess_(device, toShader(intrinsics)),
      allocate_(device),
      integrate_(device),
      tracker_(device, settings, intrinsics, templatesFor(settings)) {}

void Pipeline::changeLive(const Settings& settings) {
  Settings changed = settings_;
  for (const SettingsField& field : settingsTable())
    if (isLiveSetting(field.key)) setField(changed, field.key, fieldText(settings, field), "a live change");
  requireConsistent(changed);
  settings_ = changed;
}

FrameResult Pipeline::processFrame(const Frame& frame) {
  FrameResult result;
  result.timestamp = frame.timestamp;
  const StageTimer total(result.milliseconds.total);
  {
    const StageTimer timer(result.milliseconds.preprocess);
    preprocess(frame);
  }
  {
    const StageTimer timer(result.milliseconds.track);
    track(result);
  }
  if (result.status == TrackingStatus::Lost) {
    if (started_) tracker_.lose();
    return result;
  }
  const bool fuse = result.status != TrackingStatus::Relocalised;
  if (fuse) {
    const StageTimer timer(result.milliseconds.integrate);
    integrate(result.world_from_camera);
    started_ = true;
  }
  tracker_.accept(result.world_from_camera, result.timestamp, fuse);
  return result;
}

void Pipeline::preprocess(const Frame& frame) {
  const cv::Mat depth = frame.depth.isContinuous() ? frame.depth : frame.depth.clone();
  if (depth.type() != CV_16UC1 || depth.cols != intrinsics_.width || depth.rows != intrinsics_.height)
    throw InputError("A depth frame must be a 16-bit image of " + std::to_string(intrinsics_.width) + " x " +
                     std::to_string(intrinsics_.height) + " pixels, as the camera was described.");
  preprocess_.record(recorder_, {depth.ptr<std::uint16_t>(), depth.total()},
                     static_cast<float>(1 / depth_units_per_metre_), static_cast<float>(settings_.depth.min),
                     static_cast<float>(settings_.depth.max), static_cast<float>(settings_.depth.edge_sigmas),
                     toShader(settings_.depth));
  recorder_.submit();
  if (settings_.volume.colour && frame.colour.size() == depth.size() && frame.colour.type() == CV_8UC3)
    preprocess_.setColour(packColour(frame.colour));
  else
    preprocess_.clearColour();
}

void Pipeline::track(FrameResult& result) {
  result.world_from_camera = tracker_.last();
  result.score = tracker_.score(preprocess_, volume_, tracker_.last());
  if (!started_) {
    result.score.residual = 0;  // there is no model yet to differ from
    judge(settings_.tracking, result);
    return;
  }
  if (result.score.valid_share < settings_.tracking.min_valid_share) return judge(settings_.tracking, result);
  const TrackResult found = tracker_.track(preprocess_, volume_, result.timestamp);
  result.iterations = found.iterations;
  result.lookups = found.lookups;
  result.fit = found.fit;
  if (tracker_.isLost() || unconfirmed_ > 0) {
    const bool agrees = confirms(settings_.tracking, *found.fit);
    unconfirmed_ = !agrees ? 0 : tracker_.isLost() ? kConfirmations : unconfirmed_ - 1;
    result.status = agrees ? TrackingStatus::Relocalised : TrackingStatus::Lost;
    result.reason = agrees ? "found again; fused once the next frames agree"
                           : "the frame fits nowhere in the model surely enough";
  } else {
    result.score = tracker_.score(preprocess_, volume_, found.world_from_camera);
    judge(settings_.tracking, result);
    judgeConstraint(settings_.refine, result);
  }
  if (result.status != TrackingStatus::Lost) result.world_from_camera = found.world_from_camera;
}

void Pipeline::integrate(const Pose& world_from_camera) {
  const auto camera = toShader(intrinsics_);
  do {
    allocate_.record(recorder_, volume_, preprocess_, camera, toShader(world_from_camera));
    recorder_.submit();
  } while (allocate_.finish(volume_));
  integrate_.record(recorder_, volume_, preprocess_, camera, toShader(world_from_camera.inverse()),
                    static_cast<float>(settings_.depth.max + settings_.volume.truncation),
                    toShader(settings_.depth));
  recorder_.submit();
}

}  // namespace rosefusion
