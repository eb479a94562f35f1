// All experiments in one page that needs nothing else: pictures are in it, and no script is.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/experiments/experiment.h"

namespace rosefusion {

struct NamedResult {
  const Experiment* experiment = nullptr;
  ExperimentResult result;
};

/// What is said of a result's verdicts: "agrees", "differs" or "agrees in part", with the counts.
std::string summaryOf(const ExperimentResult& result);

/// Reads the experiments' pictures and tables from options.out. Throws InputError for one that is missing.
std::string reportHtml(const ExperimentContext& context, const std::vector<NamedResult>& results);

}  // namespace rosefusion
