// Figure plot-multires: the alternation of resolutions against single ones.
#include <spdlog/fmt/fmt.h>

#include "host/experiments/families.h"
#include "host/experiments/runs.h"

namespace rosefusion {
namespace {

constexpr double kAccurate_m = 0.02;

struct Resolutions {
  std::vector<TestSequence> rooms;
  std::vector<Variant> variants;  ///< the alternation, the finest single one, and others
};

Resolutions resolutions(const ExperimentContext& context) {
  Resolutions out;
  out.rooms = fastRooms(context);
  out.rooms.resize(std::min<std::size_t>(out.rooms.size(), context.options.quick ? 1 : 5));
  if (context.options.quick)  // the finest takes ten times as long
    for (TestSequence& room : out.rooms) {
      room.run.max_frames = 20;
      room.frames = std::min<std::size_t>(room.frames, 20);
      room.key += " first 20";
    }
  const auto levels = experimentSettings(context).swarm.levels;
  const auto single = [](int particles, int stride) {
    return Variant{fmt::format("{} / {}", particles, stride),
                   {fmt::format("swarm.levels={}/{}", particles, stride)}};
  };
  const SwarmLevel &many = levels[0], &some = levels[1], &few = levels[2];
  out.variants = {{"alternation", {}},
                  single(many.particles, few.pixel_stride),
                  single(few.particles, few.pixel_stride),
                  single(some.particles, some.pixel_stride),
                  single(many.particles, many.pixel_stride),
                  single(few.particles, many.pixel_stride)};
  return out;
}

int workMultires(const ExperimentContext& context) {
  const Resolutions r = resolutions(context);
  return static_cast<int>(r.rooms.size() * r.rooms[0].frames * r.variants.size());
}

ExperimentResult runMultires(const ExperimentContext& context) {
  const auto [rooms, variants] = resolutions(context);
  ResultWriter out(context, "multires");
  Table table({"variant", "threshold_cm", "share_of_frames"});
  Table costs({"variant", "lookups_per_frame", "iterations_per_frame", "error_cm", "lost"});
  Table times({"variant", "milliseconds_per_frame"});
  Plot plot;
  plot.width_px = 1700;
  plot.height_px = 640;
  plot.commands =
      "set multiplot layout 1,2\nset key outside top center horizontal\n"
      "set xlabel \"position error after alignment (cm)\"\nset ylabel \"share of frames within (%)\"\n"
      "set yrange [0:102]\nset xrange [0:10]\nplot ";
  Table bars({"variant", "lookups"});
  std::vector<double> lookups(variants.size(), 0.0), accurate(variants.size(), 0.0),
      capped(variants.size(), 0.0);
  for (std::size_t v = 0; v < variants.size(); ++v) {
    std::vector<double> errors;
    double milliseconds = 0, iterations = 0, lost = 0;
    const auto n = static_cast<double>(rooms.size());
    for (const TestSequence& room : rooms) {
      const RunRecord r = trackOnce(context, variants[v].name, settingsOf(context, variants[v]), room);
      errors.insert(errors.end(), r.ate_m.begin(), r.ate_m.end());
      lookups[v] += r.lookups_per_frame / n;
      capped[v] += 100 * r.cappedError() / n;
      milliseconds += r.milliseconds_per_frame / n;
      iterations += r.iterations_per_frame / n;
      lost += static_cast<double>(r.lost);
    }
    accurate[v] = 100 * shareWithin(errors, kAccurate_m);
    Table curve({"cm", "share"});
    for (double cm = 0; cm <= 10; cm += 0.25) {
      const double share = shareWithin(errors, cm / 100);
      table.add({variants[v].name, cm, share});
      curve.add({cm, 100 * share});
    }
    const std::string file = fmt::format("curve{}.dat", v);
    plot.tables[file] = curve.plotData();
    plot.commands += fmt::format("{}\"{}\" with linespoints linetype {} pointinterval {} title {}",
                                 v ? ", " : "", file, v + 1, 4 + v, plotQuoted(variants[v].name));
    costs.add({variants[v].name, lookups[v], iterations, capped[v], lost});
    times.add({variants[v].name, milliseconds});
    bars.add({variants[v].name, lookups[v] / 1e6});
  }
  out.table("multires", table);
  out.table("multires_costs", costs);
  out.table("multires_times", times);
  plot.tables["bars.dat"] = bars.plotData();
  plot.commands +=
      "\nset key off\nset yrange [0.1:*]\nset xrange [-0.6:*]\nset logscale y\nset xtics rotate by 25 right\n"
      "set xlabel \"particles / stride\" offset 0,-1\nset ylabel \"TSDF lookups per frame (millions)\"\n"
      "set boxwidth 0.6\nplot \"bars.dat\" using 0:2:xticlabels(1) with boxes linetype 1 fillstyle solid "
      "0.4\n";
  out.plot("multires", plot,
           "Accuracy and cost of alternating resolutions and of single ones (particles / pixel stride).");
  out.result.ran = fmt::format(
      "{} flights of {} frames at up to 4 m/s, the paper's method with its alternation of "
      "resolutions and with one of them, or a mixture, alone.",
      rooms.size(), rooms[0].frames);
  out.result.paper =
      "The alternation is as accurate as the high-resolution settings, or more, at a tenth of their cost.";
  Verdict fine = mostOf(
      fmt::format(
          "share of frames within {:.0f} cm: the alternation is at most 5 % below the finest single setting",
          100 * kAccurate_m),
      " %", {"alternation", accurate[0]}, {{"finest", accurate[1]}}, 0.05);
  out.result.verdicts = {
      fine, within("its lookups are a tenth of the finest's", "", {"ratio", lookups[0] / lookups[1]}, 0.1),
      leastOf("it errs less than every single setting of its own cost", " cm", {"alternation", capped[0]},
              {{variants[2].name, capped[2]}, {variants[3].name, capped[3]}, {variants[4].name, capped[4]}})};
  return out.result;
}

}  // namespace

Experiment multires() {
  return {"multires", "Alternating resolutions", "Figure plot-multires", workMultires, runMultires};
}

}  // namespace rosefusion
