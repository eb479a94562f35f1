// Figure plot-complexity: the time of one iteration over particles and pixels.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "host/bench/stopwatch.h"
#include "host/experiments/families.h"
#include "host/experiments/frame_study.h"
#include "host/slam/shader_types.h"
#include "host/swarm/random.h"

namespace rosefusion {
namespace {

const std::vector<int> kParticles = {1024, 2048, 4096, 6144, 8192, 10240};

std::vector<int> strides(const ExperimentContext& context) {
  return context.options.quick ? std::vector<int>{4, 8, 16} : std::vector<int>{8, 16, 32};
}

int workComplexity(const ExperimentContext& context) {
  return static_cast<int>(kParticles.size() * strides(context).size());
}

/// Particles uniform in the unit ball.
std::vector<glm::vec4> ball(int particles, std::uint64_t seed) {
  PortableRandom random(seed);
  std::vector<glm::vec4> out;
  for (int i = 0; i < particles; ++i) {
    const Point6 d = random.direction();
    const double r = random.ballRadius();
    out.emplace_back(r * d[0], r * d[1], r * d[2], 0);
    out.emplace_back(r * d[3], r * d[4], r * d[5], 0);
  }
  return out;
}

ExperimentResult runComplexity(const ExperimentContext& context) {
  const bool cpu = context.device.info().type == DeviceType::Cpu;
  const int repeats = context.amount(15, 9);
  SynthOptions synth = experimentSynth(context, 12, 12);
  const auto sequence = std::dynamic_pointer_cast<MemorySequence>(generated("complexity", synth).open());
  const Settings settings = experimentSettings(context);
  ResultWriter out(context, "complexity");
  Table table({"particles", "stride", "pixels", "lookups"});
  Table times({"particles", "stride", "lookups", "milliseconds", "cpu_milliseconds"});
  std::vector<double> x, y;
  Plot plot;
  studyFrames(context, settings, *sequence, sequence->frames().size() - 1, 1, Pose::Identity(),
              [&](const StudiedFrame& studied) {
                ParticleEvaluator evaluator(context.device, settings, sequence->info().intrinsics,
                                            ball(kParticles.back(), context.options.seed));
                int curve = 0;
                for (const int stride : strides(context)) {
                  Table line({"particles", "ms"});
                  for (const int particles : kParticles) {
                    const SwarmPlacement swarm{toShader(studied.truth), glm::vec4(0.05f), glm::vec4(0.02f), 0,
                                               static_cast<std::uint32_t>(particles)};
                    // The least of several: what else the machine does only ever adds to it.
                    PassTime least{1e9, 1e9};
                    for (int i = -1; i < repeats; ++i) {
                      const PassTime t = timed([&] {
                        evaluator.evaluate(studied.frame, studied.volume, {stride, 0, 0}, studied.truth,
                                           studied.last, swarm);
                      });
                      if (i >= 0) least = {std::min(least.ms, t.ms), std::min(least.cpu_ms, t.cpu_ms)};
                    }
                    const double pixels = evaluator.select.selected(), lookups = pixels * particles;
                    table.add({double(particles), double(stride), pixels, lookups});
                    times.add({double(particles), double(stride), lookups, least.ms, least.cpu_ms});
                    x.push_back(lookups);
                    y.push_back(cpu ? least.cpu_ms : least.ms);
                    line.add({double(particles), y.back()});
                    context.step(1, fmt::format("{} particles", particles));
                  }
                  plot.tables[fmt::format("line{}.dat", curve++)] = line.plotData();
                }
              });
  out.table("complexity", table);
  out.table("complexity_times", times);
  const LinearFit fit = fitLine(x, y);
  Table points({"lookups", "ms", "fit"});
  for (std::size_t i = 0; i < x.size(); ++i) points.add({x[i] / 1e6, y[i], fit.offset + fit.slope * x[i]});
  plot.tables["points.dat"] = points.plotData();
  plot.width_px = 1500;
  plot.height_px = 600;
  const std::string unit = cpu ? "CPU time of an iteration (ms)" : "time of an iteration (ms)";
  plot.commands =
      "set multiplot layout 1,2\nset key inside top left vertical opaque\nset xlabel \"particles\"\nset "
      "ylabel " +
      plotQuoted(unit) + "\nset yrange [0:*]\nset xrange [0:11000]\nset xtics 2000\nplot ";
  for (std::size_t i = 0; i < strides(context).size(); ++i)
    plot.commands += fmt::format("{}\"line{}.dat\" with linespoints linetype {} title \"every {}th pixel\"",
                                 i ? ", " : "", i, i + 1, strides(context)[i]);
  plot.commands += fmt::format(
      "\nset xrange [0:*]\nset xtics autofreq\nset xlabel \"particles x pixels (millions of lookups)\"\nplot "
      "\"points.dat\" using 1:2 with points "
      "linetype 1 title \"measured\", \"\" using 1:3 with lines linetype 2 title \"{:.2f} ns a lookup, R^2 "
      "{:.4f}\"\n",
      1e6 * fit.slope, fit.r_squared);
  out.plot("complexity", plot,
           "Time of an iteration over particles, by pixel stride, and over their product.");
  out.result.ran = fmt::format(
      "One iteration of one frame, {} numbers of particles and {} strides, the least of {} "
      "repetitions. {}",
      kParticles.size(), strides(context).size(), repeats,
      cpu ? "CPU time of the process, because other work on the machine lengthens the wall time."
          : "Wall time.");
  out.result.paper = "The time grows linearly with the particles, and downsampling the depth image cuts it.";
  // Times differ from run to run; rounded down, as the limit needs it, the verdict's figure does not. The
  // plot has the rest.
  out.result.verdicts = {mostOf("time is linear in particles x pixels: R^2 above 0.99", "",
                                {"R^2", std::floor(100 * fit.r_squared) / 100}, {{"limit", 0.99}})};
  return out.result;
}

}  // namespace

Experiment complexity() {
  return {"complexity", "Time per iteration", "Figure plot-complexity", workComplexity, runComplexity};
}

}  // namespace rosefusion
