// One method over one sequence, and a store that knows what has been run already.
#pragma once
#include <string>
#include <vector>

#include "host/experiments/sequences.h"

namespace rosefusion {

struct RunRecord {
  std::size_t frames = 0;
  std::size_t lost = 0;  ///< without a pose
  std::size_t uncertain = 0;
  double ate_mean_m = 0, ate_rmse_m = 0;                   ///< over the frames with a pose; NaN without any
  double lookups_per_frame = 0, iterations_per_frame = 0;  ///< means over the frames after the first
  double milliseconds_per_frame = 0;                       ///< median
  std::vector<double> te_m;   ///< of the judged frames: without alignment; infinity where lost
  std::vector<double> ate_m;  ///< the same after alignment

  /// Mean over the judged frames of the aligned error, at most 1 m each, which is what a lost frame counts.
  double cappedError() const;
};

/// Share (0 to 1) of the errors that are at most `limit`; NaN of none.
double shareWithin(const std::vector<double>& errors, double limit);

/// Tracks the sequence, or reads what an earlier run with equal settings, sequence and device has left in
/// options.out/runs. Throws Interrupted, and what Pipeline and the sequence throw.
RunRecord trackOnce(const ExperimentContext& context, const std::string& what, const Settings& settings,
                    const TestSequence& sequence);

/// A method or variant of one, by what it changes of experimentSettings().
struct Variant {
  std::string name;
  std::vector<std::string> assignments;
};

Settings settingsOf(const ExperimentContext& context, const Variant& variant);
/// The product's own method with its preset, the paper's, and the classical ones.
Variant ours();
Variant pst();
std::vector<Variant> allMethods();

}  // namespace rosefusion
