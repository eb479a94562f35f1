// rosefusion bench: how fast the passes are on a device beside a CPU loop, how accurate tracking is, or what
// the network costs.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/chosen_settings.h"
#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/validators.h"
#include "host/bench/comparison.h"
#include "host/bench/history.h"
#include "host/bench/network_bench.h"
#include "host/bench/pass_bench.h"
#include "host/bench/sensor_suite.h"
#include "host/bench/tracking_suite.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/settings/automatic.h"

namespace rosefusion::cli {
namespace {

struct BenchArguments {
  std::string config = "default";
  std::vector<std::string> assignments;
  std::string device;
  std::string json;
  std::string history;
  std::vector<std::string> compared;
  std::string suite = "passes";
  std::optional<int> frames;
  std::optional<std::uint64_t> seed;
  BenchOptions passes;
  TrackingSuiteOptions tracking;
  double max_speed = SynthOptions{}.linear.high;
  double max_angular = SynthOptions{}.angular.high;
  std::string noise = "handa";
  SensorSuiteOptions sensors;
  std::vector<std::string> disturbances;
  std::map<std::string, std::vector<CLI::Option*>> of_suite;  // options that not every suite knows
};

/// What a suite prints while it goes on.
class Rows {
 public:
  explicit Rows(const std::string& json) : out_(json == "-" ? stderr : stdout) {}
  /// The head waits for the first row: bad input is one sentence.
  void add(const std::string& head, const std::string& row) { say((number_++ == 0 ? head : "") + row); }
  void end(const std::string& summary) const {
    if (number_ > 0) say(summary);
  }
  /// Throws where it was interrupted; after all has been written.
  void leave(bool was_interrupted) const {
    if (!was_interrupted) return;
    spdlog::warn("Interrupted after {} sequences; the figures are of these.", number_);
    throw ExitCode(kExitInterrupted);
  }

 private:
  void say(const std::string& text) const {
    std::fputs(text.c_str(), out_);
    std::fflush(out_);
  }
  std::FILE* out_;
  std::size_t number_ = 0;
};

std::string settingsName(const BenchArguments& o) {
  std::string name = o.config;
  for (const std::string& assignment : o.assignments) name += " " + assignment;
  return name;
}

Settings settingsFor(const BenchArguments& o) {
  std::vector<std::string> assignments = o.assignments;
  if (o.suite == "passes")
    assignments.insert(assignments.begin(), "volume.colour=false");  // as its yardsticks
  return resolved(chosenSettings(o.config, assignments));
}

void benchPassesOf(BenchArguments& o) {
  o.passes.settings = settingsFor(o);
  o.passes.frames = o.frames.value_or(o.passes.frames);
  if (o.passes.frames > 1000)
    throw InputError("--frames: the passes suite holds its sequence in memory; give at most 1000.");
  o.passes.seed = o.seed.value_or(o.passes.seed);
  Device device({o.device, false});
  const BenchReport report =
      benchPasses(device, o.passes, [](const std::string& what) { spdlog::info("{}", what); });
  if (o.json != "-") std::fputs(benchTable(report).c_str(), stdout);
  nlohmann::ordered_json figures = datedFigures(benchJson(report));
  figures.update({{"settings", settingsName(o)}, {"frames", o.passes.frames}, {"seed", o.passes.seed}});
  writeJson(o.json, figures.dump(2));
  if (!o.history.empty()) appendHistory(o.history, figures);
}

void compareTwo(const BenchArguments& o) {
  const std::string &before = o.compared[0], &after = o.compared[1];
  const nlohmann::ordered_json old_figures = readFigures(before), new_figures = readFigures(after);
  const FiguresComparison comparison = compareFigures(old_figures, new_figures, before, after);
  if (o.json != "-") std::fputs(comparisonTable(comparison).c_str(), stdout);
  writeJson(o.json, comparisonJson(comparison).dump(2));
}

void benchTracking(BenchArguments& o) {
  TrackingSuiteOptions& t = o.tracking;
  t.settings = settingsFor(o);
  t.settings_name = settingsName(o);
  t.first_seed = o.seed.value_or(t.first_seed);
  t.synth.frames = o.frames.value_or(t.synth.frames);
  t.synth.linear = t.synth.linear.endingAt(o.max_speed);
  t.synth.angular = t.synth.angular.endingAt(o.max_angular);
  t.synth.noise = depthNoiseFrom(o.noise);
  if (!o.disturbances.empty()) t.disturbances.clear();
  for (const std::string& word : o.disturbances) t.disturbances.push_back(disturbanceFrom(word));
  Device device({o.device, false});
  Rows rows(o.json);
  catchInterrupts();
  const TrackingReport report = trackSuite(
      device, t, [&](const TrackedSequence& row) { rows.add(trackingHead(device.info()), trackingRow(row)); },
      interrupted);
  rows.end(trackingSummary(report));
  writeJson(o.json, trackingJson(report).dump(2));
  rows.leave(report.interrupted);
}

void benchSensors(BenchArguments& o) {
  SensorSuiteOptions& s = o.sensors;
  s.settings = chosenSettings(o.config, o.assignments);
  s.settings_name = settingsName(o);
  s.seed = o.seed.value_or(s.seed);
  s.frames = o.frames.value_or(s.frames);
  s.work = o.tracking.work;
  if (o.of_suite["sensors"].front()->count() > 0) s.max_speed = o.max_speed;
  Device device({o.device, false});
  Rows rows(o.json);
  catchInterrupts();
  const SensorReport report = trackSensors(
      device, s, [&](const SensorRow& row) { rows.add(sensorHead(device.info()), sensorRow(row)); },
      interrupted);
  rows.end(sensorSummary(report));
  writeJson(o.json, sensorJson(report).dump(2));
  rows.leave(report.interrupted);
}

void benchNetworkOf(BenchArguments& o) {
  if (o.tracking.sequences.size() != 1)
    throw InputError("--suite network sends one recorded sequence; name it with --sequence.");
  const auto sequence = openSequence(o.tracking.sequences.front());
  const NetworkReport report = benchNetwork(*sequence, static_cast<std::size_t>(o.frames.value_or(200)));
  if (o.json != "-") std::fputs(networkTable(report).c_str(), stdout);
  writeJson(o.json, networkJson(report).dump(2));
}

void bench(BenchArguments& o) {
  const auto& known = o.of_suite[o.suite];
  for (const auto& [suite, options] : o.of_suite)
    for (CLI::Option* option : options)
      if (option->count() > 0 && std::find(known.begin(), known.end(), option) == known.end())
        throw InputError(option->get_name() + " means nothing to --suite " + o.suite +
                         "; leave it out, or choose --suite " + suite + ".");
  requireWritableJson(o.json);
  if (!o.compared.empty()) return compareTwo(o);
  if (!o.history.empty()) requireWritable(o.history);
  if (o.suite == "network") return benchNetworkOf(o);
  if (o.suite == "sensors") return benchSensors(o);
  o.suite == "tracking" ? benchTracking(o) : benchPassesOf(o);
}

void addPassOptions(CLI::App& c, BenchArguments& o) {
  const std::string group = "--suite passes";
  o.of_suite["passes"] = {
      c.add_option("--repeat", o.passes.repeat, "Measurements of each figure; the median is reported")
          ->check(CLI::Range(1, 10000))
          ->capture_default_str()
          ->group(group),
      c.add_option(
           "--history", o.history,
           "Also append the figures to this file, as one line of JSON with date, commit, device, driver and "
           "processor")
          ->group(group),
      c.add_option(
           "--compare", o.compared,
           "Measure nothing: print what changed from A to B, the largest change first; files written by "
           "--json or --history (its last entry; FILE#2 is its second, FILE#-2 the last but one)")
          ->expected(2)
          ->type_name("A B")
          ->group(group)};
}

void addTrackingOptions(CLI::App& c, BenchArguments& o) {
  TrackingSuiteOptions& t = o.tracking;
  auto& options = o.of_suite["tracking"] = {
      c.add_option("--rooms", t.rooms, "Flights through generated rooms, one for each seed from --seed on")
          ->check(CLI::Range(0, 100000))
          ->capture_default_str(),
      c.add_option(
          "--meshes", t.mesh_folder,
          "Folder: fly through each .ply and .obj in it as well (closed rooms or buildings in metres)"),
      c.add_option("--sequence", t.sequences,
                   "Recorded sequence with truth to track as well, may be repeated; network: the one to send")
          ->allow_extra_args(false),
      c.add_option("--stride", t.stride, "Take every K-th frame of the recorded sequences")
          ->check(CLI::Range(1, 1000000))
          ->capture_default_str(),
      c.add_option("--max-speed", o.max_speed, "Of the flights, m/s; mean and least speed follow")
          ->check(positive())
          ->capture_default_str(),
      c.add_option("--max-angular", o.max_angular, "Of the flights, rad/s")
          ->check(CLI::NonNegativeNumber)
          ->capture_default_str(),
      c.add_option("--noise", o.noise, "Depth noise of the flights (see 'rosefusion synth --help')")
          ->check(CLI::IsMember({"handa", "simkinect", "none"}))
          ->capture_default_str(),
      c.add_option(
           "--disturb", o.disturbances,
           "Cut 30 frames out of the middle of each flight, black out 10, or hold a hand into 30; the "
           "tracker must be back within 15 frames, end within 2 cm and fuse no wrong frame; may be repeated")
          ->check(CLI::IsMember({"none", "cut", "black", "hand"}))
          ->allow_extra_args(false),
      c.add_option("--work", t.work,
                   "Keep the generated sequences here and use them again; else they are removed as it goes")};
  for (CLI::Option* option : options) option->group("--suite tracking");
  o.of_suite["sensors"] = {
      c.get_option("--max-speed"), c.get_option("--work"),
      c.add_option("--sensor", o.sensors.sensors,
                   "One of the cameras of 'rosefusion synth', may be repeated [all]")
          ->allow_extra_args(false)
          ->group("--suite sensors"),
      c.add_option("--scene", o.sensors.scenes, "room, desk or object, may be repeated [all]")
          ->allow_extra_args(false)
          ->group("--suite sensors")};
  o.of_suite["network"] = {c.get_option("--sequence")};
}

}  // namespace

void addBenchCommand(CLI::App& app) {
  auto o = std::make_shared<BenchArguments>();
  CLI::App* c = app.add_subcommand(
      "bench",
      "Time the passes beside tuned CPU loops over the same data, or measure how accurate tracking is over "
      "many sequences, or what a network stream costs");
  c->add_option("--suite", o->suite,
                "What to measure: passes (each compute pass on its own), tracking (errors over sequences), "
                "sensors (the same for every simulated camera in rooms, at desks and around objects, each at "
                "three speeds) or network (milliseconds and bytes a frame over loopback)")
      ->check(CLI::IsMember({"passes", "tracking", "sensors", "network"}))
      ->capture_default_str();
  c->add_option("--config", o->config,
                "Preset (default, paper) or YAML file; the passes are timed on depth alone unless "
                "--set volume.colour=true is given")
      ->capture_default_str();
  c->add_option("--set", o->assignments, "Change one setting: key=value; may be repeated")
      ->allow_extra_args(false);
  c->add_option("--device", o->device, "Device by index, name or type (see 'rosefusion devices')");
  c->add_option(
       "--frames", o->frames,
       "Length of a generated sequence [24; tracking: 240; sensors: 90], or frames to send [network: 200]")
      ->check(CLI::Range(4, 10000));
  c->add_option("--seed", o->seed, "Of the (first) generated sequence [1; tracking: 101; sensors: 1]");
  c->add_option("--json", o->json, "Also write the figures here; '-': standard output");
  addPassOptions(*c, *o);
  addTrackingOptions(*c, *o);
  for (const char* name : {"--config", "--set", "--device", "--seed"})
    for (const char* suite : {"passes", "tracking", "sensors"})
      o->of_suite[suite].push_back(c->get_option(name));
  c->footer(
      "Examples:\n  rosefusion bench\n  rosefusion bench --device cpu --repeat 50 --json bench.json\n"
      "  rosefusion bench --history bench.jsonl && rosefusion bench --compare bench.jsonl#-2 bench.jsonl\n"
      "  rosefusion bench --suite tracking --rooms 20 --work out/rooms --json tracking.json\n"
      "  rosefusion bench --suite tracking --rooms 5 --disturb cut --disturb black --disturb hand\n"
      "  rosefusion bench --suite tracking --rooms 0 --sequence rgbd_dataset_freiburg1_rpy --config paper\n"
      "  rosefusion bench --suite sensors --sensor d400 --scene desk --seed 7\n"
      "  rosefusion bench --suite network --sequence rgbd_dataset_freiburg1_rpy\n"
      "On a busy machine trust the passes' figures by CPU time (CPU devices only). In the tracking suite a\n"
      "frame without a pose is a failure: its sequence counts as not within 3 cm, whatever its ATE.");
  c->callback([o] { bench(*o); });
}

}  // namespace rosefusion::cli
