#include "host/experiments/runs.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/core/file_io.h"
#include "host/core/log_to_spdlog.h"
#include "host/run/report.h"

namespace rosefusion {
namespace {

constexpr double kCap_m = 1;
constexpr double kLost = std::numeric_limits<double>::infinity();
constexpr int kRecordVersion =
    1;  // of the records: raise it when tracking changes, so that old ones are run again

/// FNV-1a, the same on every machine.
std::uint64_t hashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

// JSON has no infinity.
std::vector<double> finite(std::vector<double> errors) {
  for (double& e : errors) e = std::isfinite(e) ? e : -1;
  return errors;
}
std::vector<double> infinite(std::vector<double> errors) {
  for (double& e : errors) e = e < 0 ? kLost : e;
  return errors;
}

nlohmann::json toJson(const RunRecord& r) {
  return {{"frames", r.frames},
          {"lost", r.lost},
          {"uncertain", r.uncertain},
          {"ate_mean_m", r.ate_mean_m},
          {"ate_rmse_m", r.ate_rmse_m},
          {"lookups_per_frame", r.lookups_per_frame},
          {"iterations_per_frame", r.iterations_per_frame},
          {"milliseconds_per_frame", r.milliseconds_per_frame},
          {"te_m", finite(r.te_m)},
          {"ate_m", finite(r.ate_m)}};
}

RunRecord fromJson(const nlohmann::json& j) {
  const auto number = [&](const char* key) {
    return j.at(key).is_number() ? j.at(key).get<double>() : std::numeric_limits<double>::quiet_NaN();
  };
  RunRecord r;
  r.frames = j.at("frames");
  r.lost = j.at("lost");
  r.uncertain = j.at("uncertain");
  r.ate_mean_m = number("ate_mean_m");
  r.ate_rmse_m = number("ate_rmse_m");
  r.lookups_per_frame = number("lookups_per_frame");
  r.iterations_per_frame = number("iterations_per_frame");
  r.milliseconds_per_frame = number("milliseconds_per_frame");
  r.te_m = infinite(j.at("te_m"));
  r.ate_m = infinite(j.at("ate_m"));
  return r;
}

RunRecord summariseRun(const RunSummary& summary, const SequenceInfo& info, std::size_t frames) {
  RunRecord out;
  out.uncertain = summary.count(TrackingStatus::Uncertain);
  std::vector<double> times;
  for (const RunFrame& frame : summary.frames) {
    times.push_back(frame.result.milliseconds.total);
    if (&frame == &summary.frames.front()) continue;
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, summary.frames.size() - 1));
    out.lookups_per_frame += share * static_cast<double>(frame.result.lookups);
    out.iterations_per_frame += share * frame.result.iterations;
  }
  if (!times.empty()) {
    std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
    out.milliseconds_per_frame = times[times.size() / 2];
  }
  out.ate_mean_m = out.ate_rmse_m = std::numeric_limits<double>::quiet_NaN();
  std::size_t posed = trajectoryOf(summary).size(), judged = 0;
  if (const auto errors = errorsOf(summary, info)) {
    out.ate_mean_m = errors->ate_m.mean;
    out.ate_rmse_m = errors->ate_m.rmse;
    judged = errors->common_poses;
    for (const FrameError& error : errors->per_frame) {
      out.te_m.push_back(error.te_m);
      out.ate_m.push_back(error.ate_m);
    }
  }
  out.lost = frames - posed;
  out.frames = judged + out.lost;  // a recording's truth may have gaps
  out.te_m.resize(out.frames, kLost);
  out.ate_m.resize(out.frames, kLost);
  return out;
}

}  // namespace

double RunRecord::cappedError() const {
  double sum = 0;
  for (const double error : ate_m) sum += std::min(error, kCap_m);
  return ate_m.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(ate_m.size());
}

double shareWithin(const std::vector<double>& errors, double limit) {
  if (errors.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto good = std::count_if(errors.begin(), errors.end(), [&](double e) { return e <= limit; });
  return static_cast<double>(good) / static_cast<double>(errors.size());
}

RunRecord trackOnce(const ExperimentContext& context, const std::string& what, const Settings& wanted,
                    const TestSequence& test) {
  Settings settings = wanted;
  for (SwarmLevel& level : settings.swarm.levels) level.pixel_stride *= test.stride_factor;
  const DeviceInfo& device = context.device.info();
  const std::string key = fmt::format("record {}\n{} {}\n{}\n{}", kRecordVersion, device.name, device.driver,
                                      test.key, toYaml(settings));
  const auto file = context.options.out / "runs" / fmt::format("{:016x}.json", hashOf(key));
  const std::string note = what + ", " + test.name;
  if (std::ifstream in(file); in) {
    const auto stored = nlohmann::json::parse(in, nullptr, false);
    if (stored.is_object() && stored.value("key", "") == key) {
      const RunRecord record = fromJson(stored.at("record"));
      context.step(static_cast<int>(test.frames), note);
      return record;
    }
  }
  const std::shared_ptr<Sequence> sequence = test.open();
  const SequenceInfo& info = sequence->info();
  Pipeline pipeline(context.device, settings, info.intrinsics, info.depth_units_per_metre, logToSpdlog);
  SequenceSource source(*sequence, test.run);
  const RunSummary summary = reconstruct(
      source, pipeline, 0, [&](const RunProgress&) { context.progress ? context.progress(1, note) : void(); },
      context.stop);
  if (summary.end == RunEnd::Interrupted) throw Interrupted{};
  const RunRecord record = summariseRun(summary, info, test.frames);
  writeFileAtomically(file, nlohmann::json{{"key", key}, {"record", toJson(record)}}.dump() + "\n");
  return record;
}

Settings settingsOf(const ExperimentContext& context, const Variant& variant) {
  Settings settings = experimentSettings(context);
  if (variant.name == ours().name) {
    settings = loadSettings("default");
    const Settings common = experimentSettings(context);
    settings.volume = common.volume;
    settings.swarm.levels = common.swarm.levels;
    settings.tracking.seed = common.tracking.seed;
    settings.tracking.templates_per_level = common.tracking.templates_per_level;
  }
  return changed(settings, variant.assignments);
}

Variant ours() {
  return {"default", {"tracking.method=default"}};
}
Variant pst() {
  return {"pst", {"tracking.method=pst"}};
}

std::vector<Variant> allMethods() {
  std::vector<Variant> all = {ours(), pst()};
  for (const char* name : {"pfo", "pso", "gauss-newton", "icp"})
    all.push_back({name, {std::string("tracking.method=") + name}});
  return all;
}

}  // namespace rosefusion
