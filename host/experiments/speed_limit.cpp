// Figure failure-case: how fast a camera may be, by method.
#include <spdlog/fmt/fmt.h>

#include "host/experiments/families.h"
#include "host/experiments/runs.h"

namespace rosefusion {
namespace {

constexpr double kTolerance_m = 0.05;
constexpr double kSuccess = 90;  // per cent of the frames
const std::vector<int> kSpeeds = {1, 2, 3, 4, 5, 6, 7, 8};

std::vector<TestSequence> flights(const ExperimentContext& context, int speed) {
  std::vector<TestSequence> all;
  SynthOptions synth = experimentSynth(context, 120, 12);
  synth.linear = synth.linear.endingAt(speed);
  synth.angular = synth.angular.endingAt(0.55 * speed);  // 2.2 rad/s at 4 m/s, as in the paper
  synth.ramp = 0.15;
  for (int i = 0; i < context.amount(5, 1); ++i) {
    synth.seed = 700 + static_cast<std::uint64_t>(i);
    all.push_back(generated(fmt::format("room_{} at {} m/s", synth.seed, speed), synth));
  }
  return all;
}

int workSpeedLimit(const ExperimentContext& context) {
  const auto some = flights(context, 1);
  return static_cast<int>(kSpeeds.size() * some.size() * some[0].frames * allMethods().size());
}

ExperimentResult runSpeedLimit(const ExperimentContext& context) {
  const std::vector<Variant> methods = allMethods();
  ResultWriter out(context, "speed-limit");
  Table table({"speed_m_per_s", "method", "share_within_5cm", "lost_share", "flights"});
  std::vector<Table> curves(methods.size(), Table({"speed", "share"}));
  std::vector<std::vector<double>> shares(methods.size());
  for (const int speed : kSpeeds) {
    const std::vector<TestSequence> all = flights(context, speed);
    std::vector<double> within(methods.size(), 0.0), lost(methods.size(), 0.0);
    const auto n = static_cast<double>(all.size());
    for (const TestSequence& flight : all)
      for (std::size_t m = 0; m < methods.size(); ++m) {
        const RunRecord r = trackOnce(context, methods[m].name, settingsOf(context, methods[m]), flight);
        within[m] += 100 * shareWithin(r.te_m, kTolerance_m) / n;
        lost[m] += static_cast<double>(r.lost) / static_cast<double>(r.frames) / n;
      }
    for (std::size_t m = 0; m < methods.size(); ++m) {
      table.add({double(speed), methods[m].name, within[m] / 100, lost[m], n});
      curves[m].add({double(speed), within[m]});
      shares[m].push_back(within[m]);
    }
  }
  out.table("speed-limit", table);
  Plot plot;
  plot.width_px = 1100;
  plot.height_px = 700;
  plot.commands =
      "set xlabel \"largest speed of the flights (m/s)\"\nset ylabel \"frames within 5 cm of the truth "
      "(%)\"\nset yrange "
      "[0:104]\nset xrange [0.7:8.3]\nplot ";
  // Up to the first speed at which it fails: a later success is luck.
  std::vector<NamedValue> limits, means;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const std::string file = methods[m].name + ".dat";
    plot.tables[file] = curves[m].plotData();
    plot.commands += fmt::format("{}\"{}\" with linespoints linetype {} title {}", m ? ", " : "", file, m + 1,
                                 plotQuoted(methods[m].name));
    double limit = 0, mean = 0;
    for (std::size_t i = 0; i < kSpeeds.size() && shares[m][i] >= kSuccess; ++i) limit = kSpeeds[i];
    for (const double share : shares[m]) mean += share / static_cast<double>(kSpeeds.size());
    limits.push_back({methods[m].name, limit});
    means.push_back({methods[m].name, mean});
  }
  out.plot("speed-limit", plot,
           "Share of the frames within 5 cm of the truth over the largest speed, by method.");
  out.result.ran = fmt::format(
      "{} generated flights of {} frames at each of {} speeds, turning in proportion (2.2 rad/s at 4 m/s), "
      "by all methods.",
      flights(context, 1).size(), flights(context, 1)[0].frames, kSpeeds.size());
  out.result.paper = "Tracks up to 4 m/s; fails at about 5 m/s.";
  out.result.verdicts = {
      mostOf(fmt::format("pst keeps {:.0f} % of the frames up to 4 m/s", kSuccess), " m/s", limits[1],
             {{"wanted", 4}}),
      mostOf("pst is the fastest of the paper's and the classical methods, by its limit", " m/s", limits[1],
             {limits[2], limits[3], limits[4], limits[5]}),
      mostOf("and by its mean share over all speeds", " %", means[1],
             {means[2], means[3], means[4], means[5]}),
      mostOf("this program's default method is at least as fast as pst", " m/s", limits[0], {limits[1]})};
  return out.result;
}

}  // namespace

Experiment speedLimit() {
  return {"speed-limit", "How fast is too fast", "Figure failure-case", workSpeedLimit, runSpeedLimit};
}

}  // namespace rosefusion
