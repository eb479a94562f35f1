#include "host/bench/tracking_suite.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "host/bench/generated_sequence.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/log_to_spdlog.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> meshesIn(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError(folder.string() + ": there is no such folder; --meshes takes a folder with meshes.");
  std::vector<fs::path> meshes;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = lowered(entry.path().extension().string());
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && (extension == ".ply" || extension == ".obj")) meshes.push_back(entry.path());
  }
  if (meshes.empty())
    throw InputError(folder.string() + ": holds no .ply or .obj file; --meshes takes a folder with meshes.");
  std::sort(meshes.begin(), meshes.end());
  return meshes;
}

/// A sequence to be generated under this name.
struct Flight {
  std::string name;
  SynthOptions synth;
};

Recovery recoveryOf(const RunSummary& summary, const std::optional<TrajectoryErrors>& errors,
                    double view_returns) {
  Recovery out;
  out.possible = std::isfinite(view_returns);
  const auto posesAt = [&](double stamp) -> const PosePair* {
    if (errors)
      for (const FrameError& e : errors->per_frame)
        if (std::abs(e.poses.timestamp - stamp) < 1e-6) return &e.poses;
    return nullptr;
  };
  // By what was fused: a wrong pose that was told and not fused must not make the right ones look wrong.
  std::vector<PosePair> fused;
  for (const RunFrame& frame : summary.frames)
    if (const PosePair* poses = frame.result.fused ? posesAt(frame.result.timestamp) : nullptr)
      fused.push_back(*poses);
  const Pose truth_from_estimate = alignPoses(fused).truth_from_estimate;
  std::size_t after = 0;
  for (const RunFrame& frame : summary.frames) {
    const double stamp = frame.result.timestamp;
    const bool told = !frame.skipped && frame.result.status != TrackingStatus::Lost;
    const PosePair* poses = told ? posesAt(stamp) : nullptr;
    const double error =
        poses ? (truth_from_estimate * poses->estimate.translation() - poses->truth.translation()).norm()
              : std::numeric_limits<double>::infinity();
    const bool good = error <= kGoodFrame_m;
    out.wrongly_fused += frame.result.fused && !good;
    out.final_error_m = error;
    if (stamp < view_returns) continue;
    if (good && out.frames == Recovery::kNever) out.frames = after;
    ++after;
  }
  return out;
}

std::vector<Flight> flightsOf(const TrackingSuiteOptions& options) {
  std::vector<Flight> flights;
  SynthOptions synth = options.synth;
  synth.colour = options.settings.volume.colour;
  for (int i = 0; i < options.rooms; ++i) {
    synth.seed = options.first_seed + static_cast<std::uint64_t>(i);
    flights.push_back({"room_" + std::to_string(synth.seed), synth});
  }
  synth.seed = options.first_seed;
  if (!options.mesh_folder.empty())
    for (const fs::path& mesh : meshesIn(options.mesh_folder)) {
      synth.mesh_file = mesh;
      flights.push_back({mesh.filename().string(), synth});
    }
  return flights;
}

class Suite {
 public:
  Suite(Device& device, const TrackingSuiteOptions& options, const std::function<bool()>& stop)
      : device_(device), options_(options), stop_(stop) {}

  std::optional<TrackedSequence> trackGenerated(const Flight& flight, Disturbance disturbance) const {
    std::optional<ScratchFolder> scratch;
    if (options_.work.empty()) scratch.emplace("bench");
    const fs::path folder = (scratch ? scratch->path() : options_.work) / flight.name;
    const auto sequence = generatedSequence(folder, flight.synth);
    if (disturbance == Disturbance::None) return track(flight.name, *sequence, {});
    DisturbedSequence disturbed(*sequence, disturbance);
    return track(flight.name + "+" + toString(disturbance), disturbed, {}, disturbed.viewReturns());
  }

  std::optional<TrackedSequence> trackRecorded(const fs::path& path) const {
    const auto sequence = sequenceWithTruth(path, options_.settings.volume.colour);
    for (const std::string& warning : sequence->info().warnings) spdlog::warn("{}", warning);
    const fs::path whole = fs::absolute(path).lexically_normal();
    const std::string name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
    return track(name, *sequence, {.stride = options_.stride});
  }

 private:
  /// Nothing when interrupted.
  std::optional<TrackedSequence> track(const std::string& name, Sequence& sequence, const RunOptions& run,
                                       std::optional<double> view_returns = {}) const {
    const SequenceInfo& info = sequence.info();
    Pipeline pipeline(device_, options_.settings, info.intrinsics, info.depth_units_per_metre, logToSpdlog);
    SequenceSource source(sequence, run);
    const RunSummary summary = reconstruct(source, pipeline, 0, {}, stop_);
    if (summary.end == RunEnd::Interrupted) return std::nullopt;
    if (summary.end == RunEnd::DeviceFull) spdlog::warn("{}: {}", name, summary.end_reason);
    return judge(name, summary, info, source.expectedFrames(), pipeline, view_returns);
  }

  Device& device_;
  const TrackingSuiteOptions& options_;
  const std::function<bool()>& stop_;
};

}  // namespace

ErrorSummary TrackingReport::ateOfSequences() const {
  std::vector<double> errors;
  for (const TrackedSequence& s : sequences)
    if (s.ate_m.count > 0) errors.push_back(s.ate_m.rmse);
  return summarise(errors);
}

std::size_t TrackingReport::total(std::size_t TrackedSequence::*count) const {
  std::size_t sum = 0;
  for (const TrackedSequence& s : sequences) sum += s.*count;
  return sum;
}

std::size_t TrackingReport::goodSequences() const {
  return static_cast<std::size_t>(
      std::count_if(sequences.begin(), sequences.end(), [](const TrackedSequence& s) { return s.good(); }));
}

TrackedSequence judge(const std::string& name, const RunSummary& summary, const SequenceInfo& info,
                      std::size_t frames, Pipeline& pipeline, std::optional<double> view_returns) {
  TrackedSequence out;
  out.name = name;
  out.tracked = summary.count(TrackingStatus::Tracked);
  out.uncertain = summary.count(TrackingStatus::Uncertain);
  out.lost = frames - out.tracked - out.uncertain - summary.count(TrackingStatus::Relocalised);
  out.report = reportJson(summary, info, pipeline);
  const auto median = [](const nlohmann::ordered_json& figures) {
    return figures.at("median").is_number() ? figures.at("median").get<double>() : 0;
  };
  out.ms_per_frame = median(out.report.at("milliseconds").at("total"));
  out.lookups_per_frame = median(out.report.at("lookups_per_frame"));
  const auto errors = errorsOf(summary, info);
  if (view_returns) out.recovery = recoveryOf(summary, errors, *view_returns);
  if (errors) {
    out.ate_m = errors->ate_m;
    out.te_m = errors->te_m;
    out.good_frames = static_cast<std::size_t>(
        std::count_if(errors->per_frame.begin(), errors->per_frame.end(),
                      [](const FrameError& frame) { return frame.ate_m <= kGoodFrame_m; }));
    // A recording's truth may have gaps: a pose that cannot be judged is no frame of this suite.
    frames -= errors->estimate_poses - errors->common_poses;
  }
  out.frames = frames;
  return out;
}

TrackingReport trackSuite(Device& device, const TrackingSuiteOptions& options,
                          const std::function<void(const TrackedSequence&)>& done,
                          const std::function<bool()>& stop) {
  requirePlausible(options.synth);
  const std::vector<Flight> flights = flightsOf(options);
  for (const fs::path& path : options.sequences) sequenceWithTruth(path, false);
  if (flights.empty() && options.sequences.empty())
    throw InputError("There is no sequence to track; give --rooms, --meshes or --sequence.");
  TrackingReport report{device.info(), options, {}, false};
  const Suite suite(device, options, stop);
  const auto add = [&](std::optional<TrackedSequence> sequence) {
    report.interrupted = !sequence;
    if (!sequence) return false;
    report.sequences.push_back(std::move(*sequence));
    if (done) done(report.sequences.back());
    return true;
  };
  for (const Flight& flight : flights)
    for (const Disturbance disturbance : options.disturbances)
      if (!add(suite.trackGenerated(flight, disturbance))) return report;
  for (const fs::path& path : options.sequences)
    if (!add(suite.trackRecorded(path))) return report;
  return report;
}

}  // namespace rosefusion
