// Tracking over many sequences with known truth, most of them generated: how accurate, how often it fails.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/bench/disturbed_sequence.h"
#include "host/run/report.h"
#include "host/synth/options.h"

namespace rosefusion {

struct TrackingSuiteOptions {
  Settings settings;
  std::string settings_name;  ///< preset and changes, for the report
  SynthOptions synth;         ///< of every generated sequence; seed and mesh are set for each
  std::uint64_t first_seed = 101;
  int rooms = 10;                     ///< with the seeds first_seed, first_seed + 1, ...
  std::filesystem::path mesh_folder;  ///< a flight through each .ply and .obj in it, first_seed
  /// Every generated flight is tracked once with each of these.
  std::vector<Disturbance> disturbances{Disturbance::None};
  std::vector<std::filesystem::path> sequences;  ///< recorded ones
  std::size_t stride = 1;                        ///< of `sequences`: every stride-th frame
  std::filesystem::path work;                    ///< keeps the generated sequences; empty: a temporary folder
};

/// A frame is good when its camera position, after alignment, is at most this far from the truth.
inline constexpr double kGoodFrame_m = 0.03;

/// How tracking came back after a disturbance. Frames are good here after an alignment by the fused ones
/// alone.
struct Recovery {
  static constexpr std::size_t kNever = ~std::size_t(0);
  static constexpr std::size_t kMostFrames = 15;
  static constexpr double kFinalError_m = 0.02;
  bool possible = false;          ///< whether the camera sees again what it saw before
  std::size_t frames = kNever;    ///< from then until a pose was believed that is good
  std::size_t wrongly_fused = 0;  ///< frames, in the whole run, that were fused and are not good
  double final_error_m = 0;       ///< of the last frame; infinite when it was lost
  bool good() const {
    return wrongly_fused == 0 && (!possible || (frames <= kMostFrames && final_error_m < kFinalError_m));
  }
};

/// One sequence of the suite.
struct TrackedSequence {
  std::string name;
  std::size_t frames = 0;  ///< that there are to track
  std::size_t tracked = 0;
  std::size_t uncertain = 0;
  std::size_t lost = 0;           ///< without a pose: called lost, unreadable, or not reached
  std::size_t good_frames = 0;    ///< see kGoodFrame_m; a lost frame is none
  ErrorSummary ate_m, te_m;       ///< over the frames with a pose: see `lost` beside them
  double ms_per_frame = 0;        ///< median
  double lookups_per_frame = 0;   ///< median
  nlohmann::ordered_json report;  ///< reportJson's

  std::optional<Recovery> recovery;  ///< of a disturbed sequence

  /// No frame was lost and all are good; or, after a disturbance, that the tracker came back as it must.
  bool good() const { return recovery ? recovery->good() : frames > 0 && good_frames == frames; }
};

struct TrackingReport {
  DeviceInfo device;
  TrackingSuiteOptions options;
  std::vector<TrackedSequence> sequences;
  bool interrupted = false;

  /// Of the sequences' ATE; a sequence without any common pose has none.
  ErrorSummary ateOfSequences() const;
  std::size_t total(std::size_t TrackedSequence::*count) const;
  std::size_t goodSequences() const;
};

/// Sums up one run over a sequence with truth, of which `frames` were to be tracked. `view_returns`: see
/// DisturbedSequence.
TrackedSequence judge(const std::string& name, const RunSummary& summary, const SequenceInfo& info,
                      std::size_t frames, Pipeline& pipeline, std::optional<double> view_returns = {});

/// Generates (or finds in `work`, when it holds the same sequence), tracks and judges one sequence after the
/// other; the same options on the same device give the same errors. `done` is told each one's figures, `stop`
/// asked before each frame: true leaves out the sequence under way and the rest. Throws InputError, before
/// any long work where that can be known, for a missing or empty mesh folder, a sequence that cannot be read
/// or has no truth, and a mesh or options that give no sequence; DeviceError as Pipeline does.
TrackingReport trackSuite(Device& device, const TrackingSuiteOptions& options,
                          const std::function<void(const TrackedSequence&)>& done = {},
                          const std::function<bool()>& stop = {});

nlohmann::ordered_json trackingJson(const TrackingReport& report);
/// A table for people: its head, a row for each sequence, and what stands below. Each ends its last line.
std::string trackingHead(const DeviceInfo& device);
std::string trackingRow(const TrackedSequence& sequence);
std::string trackingSummary(const TrackingReport& report);

}  // namespace rosefusion
