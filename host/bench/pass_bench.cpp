#include "host/bench/pass_bench.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <thread>

#include "engine/passes/extract.h"
#include "engine/passes/raycast.h"
#include "engine/passes/refine.h"
#include "host/bench/bench_scene.h"
#include "host/bench/native_fitness.h"
#include "host/bench/native_loop.h"
#include "host/bench/native_pairs.h"
#include "host/bench/native_raycast.h"
#include "host/bench/native_refine.h"
#include "host/bench/pass_agreement.h"
#include "host/core/log_to_spdlog.h"
#include "host/slam/shader_types.h"
#include "host/swarm/template_sampling.h"

namespace rosefusion {
namespace {

// The swarm's size in the middle of a search on fast motion; larger swarms leave the mapped space, where
// lookups are cheap for both sides.
constexpr float kTranslationLength = 0.1f;  // metres
constexpr float kRotationLength = 0.05f;    // of the quaternion's imaginary part

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

class Bench {
 public:
  Bench(Device& device, const BenchOptions& options, int threads)
      : device_(device),
        options_(options),
        threads_(threads),
        loss_(options.settings.swarm.loss == FitnessLoss::Squared ? Loss::Squared : Loss::Absolute),
        scene_(device, options),
        // The native loops know no colour.
        twins_(!options.settings.volume.colour) {}

  void measureFusion(BenchReport& report) {
    NativePairs preprocess, integrate;
    std::vector<PassTime> allocate, alone;
    std::optional<NativeVolume> twin;
    NativeFrame frame;
    std::vector<std::uint32_t> slots;
    double apart = 0;
    // The first round makes the blocks; what is reported is the steady state.
    for (int round = -1; round < (options_.repeat + 4) / 5; ++round) {
      const bool counted = round >= 0;
      for (std::size_t i = 0; i < scene_.frames(); ++i) {
        preprocess.measure(
            counted, [&] { scene_.load(i); },
            [&] { nativePreprocess(scene_.preprocessing(), scene_.raw(i), frame, threads_); });
        const std::vector<float> depth = scene_.fetch<float>(scene_.frame().depth, frame.depth.size());
        apart = std::max(
            apart, pixelsApart(depth, scene_.fetch<glm::vec4>(scene_.frame().points, frame.points.size()),
                               scene_.frame().reach().farthest, frame));
        const PassTime a = timed([&] { scene_.allocateBlocks(i); });
        if (counted) allocate.push_back(a);
        if (twin)
          integrate.measure(
              counted, [&] { scene_.integrate(i); },
              [&] {
                scene_.visibleBlocks(i, slots);
                nativeIntegrate(*twin, slots, depth, scene_.fusion(i), threads_);
              });
        else if (const PassTime t = timed([&] { scene_.integrate(i); }); counted)
          alone.push_back(t);
      }
      if (!counted && twins_) twin.emplace(scene_.volume().download(), scene_.volume().options().voxel_size);
    }
    report.preprocess = preprocess.figures();
    report.preprocess.differing = requireShare(device_.info().name, "preprocess", apart, kPixelsApart);
    report.allocate = median(allocate);
    if (twin) {
      report.integrate = integrate.figures();
      report.integrate.differing = requireShare(device_.info().name, "integrate",
                                                voxelsApart({scene_.volume().download(), twin->voxel_size},
                                                            *twin, scene_.volume().options().max_weight),
                                                kVoxelsApart);
    } else {
      report.integrate.device = median(alone);
    }
    report.blocks = scene_.volume().blockCount();
    report.volume_bytes = scene_.volume().memoryBytes();
  }

  void measureFitness(BenchReport& report) {
    const NativeVolume native(scene_.volume().download(), scene_.volume().options().voxel_size);
    const std::vector<glm::vec4> templates = templatesFor(options_.settings);
    FitnessPass compensated(device_, templates, loss_, true), plain(device_, templates, loss_, false);
    SelectPointsPass select(device_, scene_.camera());
    FitnessFigures& out = report.fitness;
    std::vector<double> device_ns, native_ns, ratios, cpu_ratios, kahan, kahan_cpu;
    for (int run = -1; run < options_.repeat; ++run) {  // the first one warms up
      // Different frames, each with the swarm around its true pose.
      const std::size_t frame = frameOf(run);
      scene_.load(frame);
      PassTime with, without, loop;
      std::uint64_t lookups = 0;
      SwarmPlacement swarm{toShader(scene_.truth(frame)), glm::vec4(kTranslationLength),
                           glm::vec4(kRotationLength)};
      for (const SwarmLevel& level : options_.settings.swarm.levels) {
        swarm.particles = static_cast<std::uint32_t>(level.particles);
        const std::vector<glm::vec4> points = scene_.selectPoints(select, level.pixel_stride);
        const auto evaluate = [&](FitnessPass& pass) {
          return timed([&] {
            pass.record(scene_.recorder(), scene_.volume(), select, swarm);
            scene_.recorder().submit();
          });
        };
        std::vector<float> losses;
        const auto loopOnce = [&] {
          return timed([&] { losses = nativeLosses(native, templates, points, swarm, loss_, threads_); });
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

  /// Two candidates, as descents that start from the last pose and from the motion model's have them.
  void measureRefine(BenchReport& report) {
    const Settings& settings = options_.settings;
    const NativeVolume native(scene_.volume().download(), scene_.volume().options().voxel_size);
    const RefineWeights weights{static_cast<float>(settings.refine.huber), toShader(settings.depth),
                                static_cast<float>(settings.refine.model_noise), settings.refine.front_only};
    RefinePass refine(device_);
    SelectPointsPass select(device_, scene_.camera());
    NativePairs pairs;
    double apart = 0;
    for (int run = -1; run < options_.repeat; ++run) {
      const std::size_t frame = frameOf(run);
      scene_.load(frame);
      const std::vector<glm::vec4> points = scene_.selectPoints(select, settings.refine.pixel_stride);
      std::vector<shader::RefineCandidate> candidates;
      for (const double share : {0.0, 1.0})
        candidates.push_back(candidateAt(nearTruth(frame, share), scene_.truth(frame - 1)));
      std::vector<RefineSums> sums;
      pairs.measure(
          run >= 0,
          [&] {
            refine.record(scene_.recorder(), scene_.volume(), select, candidates, scene_.camera(), weights);
            scene_.recorder().submit();
          },
          [&] {
            sums = nativeRefine(native, scene_.truncation(), points, candidates, scene_.camera(), weights,
                                threads_);
          });
      apart = std::max(apart, sumsApart(refine.sums(), sums, weights.huber));
    }
    report.refine = pairs.figures();
    report.refine.differing = requireShare(device_.info().name, "refine", apart, 0);
  }

  void measureSurface(BenchReport& report) {
    measureRaycast(report);
    ExtractPass extract(device_);
    std::vector<PassTime> times;
    for (int run = -1; run < (options_.repeat + 4) / 5; ++run) {
      report.triangles = 0;
      const PassTime t = timed([&] {
        extract.run(scene_.volume(), static_cast<float>(options_.settings.mesh.min_weight),
                    [&](const ExtractBatch& batch) { report.triangles += batch.triangles.size() / 3; });
      });
      if (run >= 0) times.push_back(t);
    }
    report.extract = median(times);
  }

 private:
  /// Different ones, never the first.
  std::size_t frameOf(int run) const { return scene_.frames() - 1 - (run + 1) % (scene_.frames() / 2); }

  /// A centimetre and half a degree off, times `share`.
  Pose nearTruth(std::size_t frame, double share) const {
    Pose pose = scene_.truth(frame);
    pose.translation() += share * Eigen::Vector3d(0.006, -0.005, 0.006);
    pose.linear() *=
        Eigen::AngleAxisd(0.008 * share, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    return pose;
  }

  shader::RefineCandidate candidateAt(const Pose& pose, const Pose& last) const {
    const glm::vec4 k = scene_.camera().focal_centre;
    const glm::mat4 image(k.x, 0, 0, 0, 0, k.y, 0, 0, k.z, k.w, 1, 0, 0, 0, 0, 1);
    return {toShader(pose), image * toShader(last.inverse() * pose)};
  }

  void measureRaycast(BenchReport& report) {
    RaycastPass raycast(device_, scene_.camera());
    const NativeVolume native(scene_.volume().download(), scene_.volume().options().voxel_size);
    NativePairs pairs;
    NativeView twin;
    std::vector<PassTime> alone;
    double apart = 0;
    for (int run = -1; run < options_.repeat; ++run) {
      const std::size_t frame = std::size_t(run + 1) % scene_.frames();
      const RaycastView view{.world_from_camera = toShader(scene_.truth(frame)),
                             .far = static_cast<float>(options_.settings.depth.max)};
      const auto cast = [&] {
        raycast.record(scene_.recorder(), scene_.volume(), view);
        scene_.recorder().submit();
      };
      if (twins_) {
        pairs.measure(run >= 0, cast, [&] {
          nativeRaycast(native, scene_.truncation(), scene_.camera(), view, twin, threads_);
        });
        apart = std::max(apart, raysApart(raycast.surface().as<std::uint32_t>(), raycast.preview(), twin,
                                          options_.settings.volume.voxel_size));
      } else if (const PassTime t = timed(cast); run >= 0) {
        alone.push_back(t);
      }
    }
    if (twins_) {
      report.raycast = pairs.figures();
      report.raycast.differing = requireShare(device_.info().name, "raycast", apart, kRaysApart);
    } else {
      report.raycast.device = median(alone);
    }
  }

  Device& device_;
  const BenchOptions& options_;
  const int threads_;
  const Loss loss_;
  BenchScene scene_;
  const bool twins_;
};

}  // namespace

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
  Bench bench(device, options, threads);
  say("preprocess, allocate, integrate");
  bench.measureFusion(report);
  say("fitness");
  bench.measureFitness(report);
  say("refine");
  bench.measureRefine(report);
  say("raycast, extract");
  bench.measureSurface(report);
  return report;
}

}  // namespace rosefusion
