#include "host/bench/pass_bench.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "engine/passes/allocate.h"
#include "engine/passes/extract.h"
#include "engine/passes/integrate.h"
#include "engine/passes/raycast.h"
#include "host/bench/native_fitness.h"
#include "host/bench/stopwatch.h"
#include "host/core/log_to_spdlog.h"
#include "host/core/number_text.h"
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/shader_types.h"
#include "host/swarm/template_sampling.h"
#include "host/synth/sequence.h"

namespace rosefusion {
namespace {

// The swarm's size in the middle of a search on fast motion; larger swarms leave the mapped space, where
// lookups are cheap for both sides.
constexpr float kTranslationLength = 0.1f;  // metres
constexpr float kRotationLength = 0.05f;    // of the quaternion's imaginary part

constexpr double kFps = 10;  // few frames that see much

SynthSequence sequenceFor(const BenchOptions& options) {
  SynthOptions synth;
  synth.frames = options.frames;
  synth.fps = kFps;
  synth.seed = options.seed;
  synth.colour = options.settings.volume.colour;
  return makeSequence(synth);
}

std::vector<glm::vec4> templatesFor(const Settings& settings) {
  TemplateOptions options;
  options.sizes.clear();
  for (const SwarmLevel& level : settings.swarm.levels) options.sizes.push_back(level.particles);
  options.count = settings.tracking.templates_per_level;
  options.seed = settings.tracking.seed;
  const TemplateSet set = loadOrGenerate(defaultTemplateCache(options), options, {}, logToSpdlog);
  std::vector<glm::vec4> out;
  for (std::size_t level = 0; level < set.levels.size(); ++level)
    for (const Particle& p : set.at(level, 0).particles) {
      out.emplace_back(p[0], p[1], p[2], 0);
      out.emplace_back(p[3], p[4], p[5], 0);
    }
  return out;
}

std::vector<std::uint32_t> packColour(const cv::Mat& bgr) {
  std::vector<std::uint32_t> rgb;
  rgb.reserve(bgr.total());
  for (const cv::Vec3b& p : cv::Mat_<cv::Vec3b>(bgr)) rgb.push_back(p[2] | p[1] << 8 | p[0] << 16);
  return rgb;
}

class Bench {
 public:
  Bench(Device& device, const BenchOptions& options, SynthSequence sequence, std::vector<glm::vec4> templates)
      : device_(device),
        options_(options),
        sequence_(std::move(sequence)),
        templates_(std::move(templates)),
        camera_(toShader(sequence_.intrinsics)),
        loss_(options.settings.swarm.loss == FitnessLoss::Squared ? Loss::Squared : Loss::Absolute),
        recorder_(device),
        volume_(device, volumeOptions(options.settings.volume)),
        frame_(device, camera_),
        allocate_(device),
        integrate_(device) {}

  void measureFusion(BenchReport& report) {
    std::vector<PassTime> preprocess, allocate, integrate;
    // The first round makes the blocks; what is reported is the steady state.
    for (int round = -1; round < (options_.repeat + 4) / 5; ++round)
      for (std::size_t i = 0; i < sequence_.frames.size(); ++i) {
        const PassTime p = timed([&] { load(i); });
        const PassTime a = timed([&] { allocateBlocks(i); });
        const PassTime f = timed([&] { integrateFrame(i); });
        if (round < 0) continue;
        preprocess.push_back(p);
        allocate.push_back(a);
        integrate.push_back(f);
      }
    report.preprocess = median(preprocess);
    report.allocate = median(allocate);
    report.integrate = median(integrate);
    report.blocks = volume_.blockCount();
    report.volume_bytes = volume_.memoryBytes();
  }

  void measureFitness(BenchReport& report, int threads) {
    const NativeVolume native(volume_.download(), volume_.options().voxel_size);
    FitnessPass compensated(device_, templates_, loss_, true), plain(device_, templates_, loss_, false);
    SelectPointsPass select(device_, camera_);
    FitnessFigures& out = report.fitness;
    std::vector<double> device_ns, native_ns, ratios, cpu_ratios, kahan, kahan_cpu;
    for (int run = -1; run < options_.repeat; ++run) {  // the first one warms up
      // Different frames, each with the swarm around its true pose.
      const std::size_t frame = sequence_.frames.size() - 1 - (run + 1) % (sequence_.frames.size() / 2);
      load(frame);
      PassTime with, without, loop;
      std::uint64_t lookups = 0;
      SwarmPlacement swarm{toShader(truth(frame)), glm::vec4(kTranslationLength), glm::vec4(kRotationLength)};
      for (const SwarmLevel& level : options_.settings.swarm.levels) {
        swarm.particles = static_cast<std::uint32_t>(level.particles);
        const std::vector<glm::vec4> points = selectPoints(select, level.pixel_stride);
        const auto evaluate = [&](FitnessPass& pass) {
          return timed([&] {
            pass.record(recorder_, volume_, select, swarm);
            recorder_.submit();
          });
        };
        std::vector<float> losses;
        const auto loopOnce = [&] {
          return timed([&] { losses = nativeLosses(native, templates_, points, swarm, loss_, threads); });
        };
        // A B A B, and the order turned around in every second run: a load that comes or goes hits all alike.
        for (int half = 0; half < 2; ++half) {
          if ((run + half) % 2) without = without + evaluate(plain);
          with = with + evaluate(compensated);
          loop = loop + loopOnce();
          if (!((run + half) % 2)) without = without + evaluate(plain);
        }
        out.worst_loss_difference =
            std::max(out.worst_loss_difference,
                     requireAgreement(device_.info().name, compensated.losses(), losses, points.size()));
        lookups += 2 * std::uint64_t(swarm.particles) * points.size();
        swarm.first_particle += swarm.particles;
      }
      if (run < 0) continue;
      out.lookups = lookups / 2;
      device_ns.push_back(1e6 * with.ms / static_cast<double>(lookups));
      native_ns.push_back(1e6 * loop.ms / static_cast<double>(lookups));
      ratios.push_back(with.ms / loop.ms);
      cpu_ratios.push_back(with.cpu_ms / loop.cpu_ms);
      kahan.push_back(100 * (with.ms / without.ms - 1));
      kahan_cpu.push_back(100 * (with.cpu_ms / without.cpu_ms - 1));
    }
    out.ns_per_lookup = median(device_ns);
    out.native_ns_per_lookup = median(native_ns);
    out.ratio = median(ratios);
    out.cpu_ratio = median(cpu_ratios);
    out.kahan_cost_percent = median(kahan);
    out.kahan_cost_cpu_percent = median(kahan_cpu);
  }

  void measureSurface(BenchReport& report) {
    RaycastPass raycast(device_, camera_);
    std::vector<PassTime> times;
    for (int run = -1; run < options_.repeat; ++run) {
      const std::size_t frame = std::size_t(run + 1) % sequence_.frames.size();
      const PassTime t = timed([&] {
        raycast.record(recorder_, volume_,
                       {.world_from_camera = toShader(truth(frame)),
                        .far = static_cast<float>(options_.settings.depth.max)});
        recorder_.submit();
      });
      if (run >= 0) times.push_back(t);
    }
    report.raycast = median(times);

    ExtractPass extract(device_);
    times.clear();
    for (int run = -1; run < (options_.repeat + 4) / 5; ++run) {
      report.triangles = 0;
      const PassTime t = timed([&] {
        extract.run(volume_, static_cast<float>(options_.settings.mesh.min_weight),
                    [&](const ExtractBatch& batch) { report.triangles += batch.triangles.size() / 3; });
      });
      if (run >= 0) times.push_back(t);
    }
    report.extract = median(times);
  }

 private:
  const Pose& truth(std::size_t frame) const { return sequence_.truth[frame].world_from_camera; }

  void load(std::size_t i) {
    const Frame& frame = sequence_.frames[i];
    const DepthSettings& depth = options_.settings.depth;
    frame_.record(recorder_, {frame.depth.ptr<std::uint16_t>(), frame.depth.total()},
                  static_cast<float>(1 / sequence_.depth_units_per_metre), static_cast<float>(depth.min),
                  static_cast<float>(depth.max));
    recorder_.submit();
    if (frame.colour.empty()) return;
    std::ranges::copy(packColour(frame.colour), frame_.colourWords().begin());
    frame_.recordColour(recorder_);
  }

  void allocateBlocks(std::size_t i) {
    do {
      allocate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(truth(i)));
      recorder_.submit();
    } while (allocate_.finish(recorder_, volume_));
    recorder_.submit();
  }

  void integrateFrame(std::size_t i) {
    integrate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(truth(i).inverse()),
                      static_cast<float>(options_.settings.depth.max + options_.settings.volume.truncation));
    recorder_.submit();
  }

  /// Also as the host sees them.
  std::vector<glm::vec4> selectPoints(SelectPointsPass& select, int stride) {
    select.record(recorder_, frame_.frame(), {stride, stride / 2, stride / 2}, nullptr);
    recorder_.submit();
    const Buffer mapped(device_, sizeof(glm::vec4) * std::max(select.selected(), 1u), Memory::Readback);
    recorder_.copy(select.points(), mapped, mapped.bytes());
    recorder_.submit();
    const auto points = mapped.as<glm::vec4>().first(select.selected());
    return {points.begin(), points.end()};
  }

  Device& device_;
  const BenchOptions& options_;
  const SynthSequence sequence_;
  const std::vector<glm::vec4> templates_;
  const shader::CameraIntrinsics camera_;
  const Loss loss_;
  Recorder recorder_;
  Volume volume_;
  PreprocessPass frame_;
  AllocatePass allocate_;
  IntegratePass integrate_;
};

}  // namespace

double requireAgreement(const std::string& device_name, std::span<const float> device,
                        std::span<const float> native, std::size_t points) {
  double worst = 0, sum = 0;
  for (std::size_t i = 0; i < native.size(); ++i) {
    const double difference = std::abs(double(device[i]) - native[i]);
    worst = std::max(worst, std::isnan(difference) ? 2.0 : difference);
    sum += difference;
  }
  const double mean = sum / static_cast<double>(native.size());
  if (worst <= lossTolerance(points) && mean <= kMeanLossTolerance) return worst;
  throw std::runtime_error(printed(
      "%s computes other losses than the native loop: %.2e at most and %.2e in the mean differ, where "
      "%.2e and %.2e are allowed; do not trust this device's results.",
      device_name.c_str(), worst, mean, lossTolerance(points), kMeanLossTolerance));
}

BenchReport benchPasses(Device& device, const BenchOptions& options,
                        const std::function<void(const std::string&)>& progress) {
  const auto say = [&](const char* what) {
    if (progress) progress(what);
  };
  BenchReport report;
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  report.device = device.info();
  report.native = nativeInstructionSet() + ", " + std::to_string(threads) + " threads";
  report.voxel_size = options.settings.volume.voxel_size;
  report.repeat = options.repeat;
  say("making the sequence");
  Bench bench(device, options, sequenceFor(options), templatesFor(options.settings));
  say("preprocess, allocate, integrate");
  bench.measureFusion(report);
  say("fitness");
  bench.measureFitness(report, threads);
  say("raycast, extract");
  bench.measureSurface(report);
  return report;
}

}  // namespace rosefusion
