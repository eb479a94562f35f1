// Runs experiments one after the other and remembers which have been finished.
#pragma once
#include <string>
#include <vector>

#include "host/experiments/experiment.h"
#include "host/experiments/report_html.h"

namespace rosefusion {

/// The one of that name, or all for "all". Throws InputError that lists the names for another.
std::vector<const Experiment*> experimentsNamed(const std::string& name);

/// The experiment's result: read from options.out where it was finished with equal settings, data and device,
/// and its files are still there; else run, with the files in options.out/NAME and result.json written last.
/// `again`: run in any case. Throws Interrupted; what was tracked until then is not tracked again.
ExperimentResult runOrRecall(const ExperimentContext& context, const Experiment& experiment, bool again,
                             bool* recalled = nullptr);

/// For people: experiment, verdict and numbers, one line each.
std::string verdictLines(const NamedResult& result);

/// All verdicts as CSV.
Table verdictTable(const std::vector<NamedResult>& results);

}  // namespace rosefusion
