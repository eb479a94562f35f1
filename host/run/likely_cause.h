// Why a run lost most of its frames, as far as can be told.
#pragma once
#include <string>
#include <vector>

#include "host/datasets/inspection.h"
#include "host/run/reconstruction.h"

namespace rosefusion {

/// Whether more than half of the frames that could be read have no pose.
bool lostMost(const RunSummary& summary);

/// One or two sentences with the likeliest cause and its remedy: from what looks wrong with the recording,
/// else from where and how the frames were lost.
std::string likelyCause(const RunSummary& summary, const std::vector<Finding>& findings);

}  // namespace rosefusion
