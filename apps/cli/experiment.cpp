// rosefusion experiment: the paper's experiments, each with its tables, plots and verdicts; all with a
// report.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/progress.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/experiments/suite.h"

namespace rosefusion::cli {
namespace {

struct ExperimentCommandOptions {
  std::string name;
  std::string device;
  std::string json;
  bool again = false;
  ExperimentOptions experiment;
};

nlohmann::ordered_json toJson(const NamedResult& r) {
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  for (const Verdict& v : r.result.verdicts)
    verdicts.push_back({{"claim", v.claim}, {"found", v.found}, {"verdict", toString(v.agreement)}});
  return {{"experiment", r.experiment->name},
          {"figure", r.experiment->figure},
          {"summary", summaryOf(r.result)},
          {"verdicts", verdicts}};
}

void runExperiments(ExperimentCommandOptions& o) {
  const std::vector<const Experiment*> wanted = experimentsNamed(o.name);
  requireWritableJson(o.json);
  if (o.experiment.data.empty())
    if (const char* data = std::getenv("ROSEFUSION_DATA")) o.experiment.data = data;
  Device device({o.device, false});
  catchInterrupts();
  Progress bar("frames");
  std::size_t done = 0, total = 0;
  ExperimentContext context{device, o.experiment, {}, interrupted};
  for (const Experiment* experiment : wanted) total += static_cast<std::size_t>(experiment->work(context));
  std::FILE* out = o.json == "-" ? stderr : stdout;
  std::vector<NamedResult> results;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  try {
    for (const Experiment* experiment : wanted) {
      const auto work = static_cast<std::size_t>(experiment->work(context));
      const std::size_t end = done + work;
      context.progress = [&](int frames, const std::string& what) {
        done = std::min(end, done + static_cast<std::size_t>(frames));
        bar.update(done, total, experiment->name + ": " + what);
      };
      bool recalled = false;
      results.push_back({experiment, runOrRecall(context, *experiment, o.again, &recalled)});
      // What took no time must not make the rest look short.
      if (recalled)
        total -= work;
      else
        done = end;
      std::fputs(verdictLines(results.back()).c_str(), out);
      std::fflush(out);
      json.push_back(toJson(results.back()));
    }
  } catch (const Interrupted&) {
    spdlog::warn("Interrupted; the same command goes on from here.");
    throw ExitCode(kExitInterrupted);
  }
  const auto& folder = o.experiment.out;
  if (o.name == "all") {
    writeFileAtomically(folder / "verdicts.csv", verdictTable(results).csv());
    writeFileAtomically(folder / "report.html", reportHtml(context, results));
    std::fprintf(out, "%s\n", (folder / "report.html").c_str());
  } else {
    std::fprintf(out, "%s\n", (folder / o.name).c_str());
  }
  writeJson(o.json, json.dump(2));
}

}  // namespace

void addExperimentCommand(CLI::App& app) {
  auto o = std::make_shared<ExperimentCommandOptions>();
  o->experiment.out = "out/experiments";
  CLI::App* c = app.add_subcommand("experiment",
                                   "Repeat the paper's experiments: tables (CSV), plots (PNG), and whether "
                                   "the paper's findings hold here; 'all' "
                                   "also writes one page, report.html");
  std::string names;
  for (const Experiment& e : experiments()) names += (names.empty() ? "" : ", ") + e.name;
  c->add_option("NAME", o->name, "all, or one of " + names)->required();
  c->add_flag("--quick", o->experiment.quick, "Images of 320 x 240 and few frames; as many particles");
  c->add_option(
      "--data", o->experiment.data,
      "Folder with recorded sequences, which 'accuracy' and 'frames' use as well [$ROSEFUSION_DATA]");
  c->add_option("--out", o->experiment.out, "Folder for the results; what it holds already is not run again")
      ->capture_default_str();
  c->add_flag("--again", o->again,
              "Draw finished experiments again (their tracked sequences are kept in OUT/runs)");
  c->add_option("--seed", o->experiment.seed, "Of the swarms")->capture_default_str();
  c->add_option("--shrink", o->experiment.shrink,
                "Divide frames, rooms and particles by this; for a first look only")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  c->add_option("--device", o->device, "Device by index, name or type (see 'rosefusion devices')");
  c->add_option("--json", o->json, "Also write the verdicts here; '-': standard output");
  c->footer(
      "Examples:\n  rosefusion experiment all --quick\n  rosefusion experiment speed-limit --out out/limit\n"
      "  rosefusion experiment accuracy --data ~/rgbd\n"
      "The tables are the same for a seed and a device; times are in tables of their own (*_times.csv).");
  c->callback([o] { runExperiments(*o); });
}

}  // namespace rosefusion::cli
