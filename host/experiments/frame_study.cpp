#include "host/experiments/frame_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/log_to_spdlog.h"
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

VolumeOptions withoutColour(VolumeSettings settings) {
  settings.colour = false;
  return volumeOptions(settings);
}

/// Preprocess, allocate and integrate at poses that are given.
class KnownPoseFusion {
 public:
  KnownPoseFusion(Device& device, const Settings& settings, const SequenceInfo& info)
      : settings_(settings),
        camera_(toShader(info.intrinsics)),
        metres_per_unit_(static_cast<float>(1 / info.depth_units_per_metre)),
        recorder_(device),
        volume_(device, withoutColour(settings.volume)),
        frame_(device, camera_),
        allocate_(device),
        integrate_(device) {}

  void load(const Frame& frame) {
    frame_.record(recorder_, {frame.depth.ptr<std::uint16_t>(), frame.depth.total()}, metres_per_unit_,
                  static_cast<float>(settings_.depth.min), static_cast<float>(settings_.depth.max),
                  static_cast<float>(settings_.depth.edge_sigmas), toShader(settings_.depth));
    recorder_.submit();
  }
  void fuse(const Pose& world_from_camera) {
    do {
      allocate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(world_from_camera));
      recorder_.submit();
    } while (allocate_.finish(recorder_, volume_));
    integrate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(world_from_camera.inverse()),
                      static_cast<float>(settings_.depth.max + settings_.volume.truncation),
                      toShader(settings_.depth));
    recorder_.submit();
  }
  const DeviceFrame& frame() const { return frame_.frame(); }
  const Volume& volume() const { return volume_; }

 private:
  const Settings settings_;
  shader::CameraIntrinsics camera_;
  float metres_per_unit_;
  Recorder recorder_;
  Volume volume_;
  PreprocessPass frame_;
  AllocatePass allocate_;
  IntegratePass integrate_;
};

TemplateSet templatesOf(const Settings& settings) {
  TemplateOptions options;
  options.sizes.clear();
  for (const SwarmLevel& level : settings.swarm.levels) options.sizes.push_back(level.particles);
  options.count = settings.tracking.templates_per_level;
  options.seed = settings.tracking.seed;
  return loadOrGenerate(defaultTemplateCache(options), options, {}, logToSpdlog);
}

/// Least, quartiles and most of what counts.
std::array<double, 5> quartiles(std::span<const float> losses, double (*fitness)(double)) {
  std::vector<double> values;
  for (const float loss : losses)
    if (loss >= 0) values.push_back(fitness(loss));
  std::array<double, 5> out;
  out.fill(std::numeric_limits<double>::quiet_NaN());
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = values[i * (values.size() - 1) / 4];
  return out;
}

double absoluteFitness(double loss) {
  return 1 - loss;
}
double squaredFitness(double loss) {
  return 1 - std::sqrt(loss);
}

}  // namespace

void studyFrames(const ExperimentContext& context, const Settings& settings, const MemorySequence& sequence,
                 std::size_t first, std::size_t every, const Pose& world_from_truth,
                 const std::function<void(const StudiedFrame&)>& study) {
  KnownPoseFusion fusion(context.device, settings, sequence.info());
  const auto pose = [&](std::size_t i) {
    return Pose(world_from_truth * sequence.info().truth[i].world_from_camera);
  };
  for (std::size_t i = 0; i < sequence.frames().size(); ++i) {
    fusion.load(sequence.frames()[i]);
    if (i >= first && (i - first) % every == 0)
      study({i, fusion.frame(), fusion.volume(), pose(i - 1), pose(i)});
    fusion.fuse(pose(i));
  }
}

StudiedMethod::StudiedMethod(Device& device, const Settings& settings, const Intrinsics& intrinsics)
    : settings_((requireConsistent(settings), settings)),
      swarm_(device, settings, intrinsics, templatesOf(settings)),
      refiner_(device, settings, intrinsics),
      method_(makePoseMethod(device, settings, intrinsics, swarm_, refiner_)) {}

void StudiedMethod::search(const StudiedFrame& studied, const SearchObserver& observer) {
  TrackHistory history;
  history.last = studied.last;
  method_->track(studied.frame, studied.volume, history, 0, observer);
}

std::vector<SearchState> StudiedMethod::search(const StudiedFrame& studied) {
  const auto steps = static_cast<std::size_t>(settings_.swarm.max_iterations);
  std::vector<SearchState> states;
  std::array<double, 5> none;
  none.fill(std::numeric_limits<double>::quiet_NaN());
  if (settings_.tracking.method == TrackingMethod::GaussNewton) {
    // The descent tells nothing of its steps, but ends after any number of them.
    refiner_.selectPixels(studied.frame, settings_.refine.coarse_pixel_stride);
    states.push_back({studied.last, none});
    for (std::size_t i = 1; i <= steps; ++i)
      states.push_back(
          {refiner_
               .refine(studied.volume, std::vector<Pose>{studied.last}, static_cast<int>(i), studied.last)[0]
               .world_from_camera,
           none});
    return states;
  }
  const auto fitness = settings_.swarm.loss == FitnessLoss::Squared ? squaredFitness : absoluteFitness;
  TrackHistory history;
  history.last = studied.last;
  const TrackResult result =
      method_->track(studied.frame, studied.volume, history, 0, [&](const SearchIteration& iteration) {
        states.push_back({iteration.state.centre, none});
        // What this iteration looked at belongs to the state after it.
        states[states.size() - 1].fitness = quartiles(iteration.losses, fitness);
      });
  states.push_back({result.world_from_camera, none});
  for (std::size_t i = states.size() - 1; i > 0; --i) states[i].fitness = states[i - 1].fitness;
  states[0].fitness = none;
  states.resize(steps + 1, states.back());  // ended early: it stays where it is
  return states;
}

double StudiedMethod::fitness(const StudiedFrame& studied, const Pose& pose) {
  return 1 - swarm_.score(studied.frame, studied.volume, pose, studied.last).residual;
}

}  // namespace rosefusion
