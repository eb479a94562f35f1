#include "host/experiments/suite.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/experiments/runs.h"

namespace rosefusion {
namespace {

constexpr int kExperimentVersion =
    1;  // of the experiments: raise it when one of them changes, so that old results are made anew

std::string keyOf(const ExperimentContext& context, const Experiment& experiment) {
  const DeviceInfo& device = context.device.info();
  const ExperimentOptions& o = context.options;
  std::string key =
      fmt::format("experiment {} version {}\n{} {}\nquick {} shrink {} seed {}\n", experiment.name,
                  kExperimentVersion, device.name, device.driver, o.quick, o.shrink, o.seed);
  for (const TestSequence& recorded : recordedSequences(context)) key += recorded.key + "\n";
  for (const Variant& method : allMethods()) key += toYaml(settingsOf(context, method));
  return key;
}

nlohmann::ordered_json toJson(const ExperimentResult& r) {
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array(),
                         figures = nlohmann::ordered_json::array();
  for (const Verdict& v : r.verdicts)
    verdicts.push_back({{"claim", v.claim}, {"found", v.found}, {"verdict", toString(v.agreement)}});
  for (const Figure& f : r.figures) figures.push_back({{"file", f.file}, {"caption", f.caption}});
  return {
      {"ran", r.ran}, {"paper", r.paper}, {"verdicts", verdicts}, {"tables", r.tables}, {"figures", figures}};
}

ExperimentResult fromJson(const nlohmann::ordered_json& j) {
  ExperimentResult r;
  r.ran = j.at("ran");
  r.paper = j.at("paper");
  for (const auto& v : j.at("verdicts")) {
    Verdict& verdict = r.verdicts.emplace_back(Verdict{v.at("claim"), v.at("found"), Agreement::Open});
    for (const Agreement a : {Agreement::Agrees, Agreement::Differs})
      if (v.at("verdict") == toString(a)) verdict.agreement = a;
  }
  for (const auto& table : j.at("tables")) r.tables.push_back(table);
  for (const auto& f : j.at("figures")) r.figures.push_back({f.at("file"), f.at("caption")});
  return r;
}

}  // namespace

std::vector<const Experiment*> experimentsNamed(const std::string& name) {
  std::vector<const Experiment*> found;
  std::string names = "all";
  for (const Experiment& e : experiments()) {
    names += ", " + e.name;
    if (name == "all" || name == e.name) found.push_back(&e);
  }
  if (found.empty()) throw InputError("There is no experiment '" + name + "'; choose one of " + names + ".");
  return found;
}

ExperimentResult runOrRecall(const ExperimentContext& context, const Experiment& experiment, bool again,
                             bool* recalled) {
  const auto folder = context.options.out / experiment.name;
  const auto file = folder / "result.json";
  const std::string key = keyOf(context, experiment);
  if (recalled) *recalled = false;
  if (std::ifstream in(file); in && !again) {
    const auto stored = nlohmann::ordered_json::parse(in, nullptr, false);
    if (stored.is_object() && stored.value("key", "") == key) {
      ExperimentResult result = fromJson(stored.at("result"));
      const auto there = [&](const std::string& name) { return std::filesystem::exists(folder / name); };
      if (std::all_of(result.tables.begin(), result.tables.end(), there) &&
          std::all_of(result.figures.begin(), result.figures.end(),
                      [&](const Figure& f) { return there(f.file); })) {
        if (recalled) *recalled = true;
        return result;
      }
    }
  }
  std::error_code error;
  std::filesystem::remove(file, error);
  const ExperimentResult result = experiment.run(context);
  writeFileAtomically(file, nlohmann::ordered_json{{"key", key}, {"result", toJson(result)}}.dump(2) + "\n");
  return result;
}

std::string verdictLines(const NamedResult& r) {
  std::string out =
      fmt::format("{} ({}): {}\n", r.experiment->name, r.experiment->figure, summaryOf(r.result));
  for (const Verdict& v : r.result.verdicts)
    out += fmt::format("  {:<8}{}\n          {}\n", toString(v.agreement), v.claim, v.found);
  return out;
}

Table verdictTable(const std::vector<NamedResult>& results) {
  Table table({"experiment", "figure", "claim", "found", "verdict"});
  for (const NamedResult& r : results)
    for (const Verdict& v : r.result.verdicts)
      table.add({r.experiment->name, r.experiment->figure, v.claim, v.found, toString(v.agreement)});
  return table;
}

}  // namespace rosefusion
