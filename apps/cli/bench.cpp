// rosefusion bench: how fast the passes are on a device, and how fast a CPU loop is beside them.
#include "host/bench/pass_bench.h"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"

namespace rosefusion::cli {
namespace {

struct Options {
  std::string config = "default";
  std::vector<std::string> assignments;
  std::string device;
  std::string json;
  std::string suite = "passes";
  BenchOptions bench;
};

void bench(Options& o) {
  Settings& settings = o.bench.settings;
  settings = loadSettings(o.config);
  settings.volume.colour = false;
  for (const std::string& assignment : o.assignments) applyAssignment(settings, assignment);
  requireConsistent(settings);
  Device device({o.device, false});
  const BenchReport report =
      benchPasses(device, o.bench, [](const std::string& what) { spdlog::info("{}", what); });
  if (o.json != "-") std::fputs(benchTable(report).c_str(), stdout);
  writeJson(o.json, benchJson(report).dump(2));
}

}  // namespace

void addBenchCommand(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "bench", "Time the passes on a generated sequence, beside a tuned CPU loop over the same data");
  c->add_option("--suite", o->suite, "What to measure: passes (each compute pass on its own)")
      ->check(CLI::IsMember({"passes"}))
      ->capture_default_str();
  c->add_option("--config", o->config,
                "Preset (default, paper) or YAML file; depth alone is fused unless "
                "--set volume.colour=true is given")
      ->capture_default_str();
  c->add_option("--set", o->assignments, "Change one setting: key=value; may be repeated")
      ->allow_extra_args(false);
  c->add_option("--device", o->device, "Device by index, name or type (see 'rosefusion devices')");
  c->add_option("--repeat", o->bench.repeat, "Measurements of each figure; the median is reported")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  c->add_option("--frames", o->bench.frames, "Length of the generated sequence")
      ->check(CLI::Range(4, 1000))
      ->capture_default_str();
  c->add_option("--seed", o->bench.seed, "Of the generated sequence")->capture_default_str();
  c->add_option("--json", o->json, "Also write the figures here; '-': standard output");
  c->footer(
      "Examples:\n  rosefusion bench\n  rosefusion bench --device cpu --repeat 50 --json bench.json\n"
      "On a busy machine trust the figures by CPU time (CPU devices only).");
  c->callback([o] { bench(*o); });
}

}  // namespace rosefusion::cli
