// What a run is summed up as: report.json, frames.csv.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "host/evaluation/trajectory_error.h"
#include "host/run/reconstruction.h"

namespace rosefusion {

/// Errors against the sequence's truth over the selected frames; none when there is no truth.
std::optional<TrajectoryErrors> errorsOf(const RunSummary& summary, const SequenceInfo& info);

/// The keys are documented in the README: device, frames, tracked, uncertain, lost, milliseconds, iterations,
/// lookups_per_frame, memory_bytes, and with truth the keys of `rosefusion eval`; ate_ and rpe_ are null with
/// fewer than kFewestCommonPoses.
nlohmann::ordered_json reportJson(const RunSummary& summary, const SequenceInfo& info, Pipeline& pipeline);

/// One row per frame, with units in the header.
std::string framesCsv(const RunSummary& summary);

}  // namespace rosefusion
