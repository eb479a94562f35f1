#include <algorithm>

#include "host/bench/tracking_suite.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const TrackedSequence& s) {
  Json json = {{"name", s.name},         {"judged_frames", s.frames},     {"good_frames", s.good_frames},
               {"within_3cm", s.good()}, {"frames_without_pose", s.lost}, {"ms_per_frame", s.ms_per_frame},
               {"report", s.report}};
  json["report"].erase("device");
  if (s.recovery) {
    const bool ever = s.recovery->frames != Recovery::kNever;
    json["recovery"] = {{"good", s.recovery->good()},
                        {"possible", s.recovery->possible},
                        {"frames", ever ? Json(s.recovery->frames) : Json()},
                        {"wrongly_fused", s.recovery->wrongly_fused},
                        {"final_error_m", s.recovery->final_error_m}};
  }
  // Those read most often, not to be looked for among the others.
  for (const char* key : {"tracked", "uncertain", "lost"}) json[key] = s.report.at(key);
  json["ate_rmse_m"] = s.ate_m.rmse;
  json["ate_max_m"] = s.ate_m.max;
  json["te_rmse_m"] = s.te_m.rmse;
  json["te_max_m"] = s.te_m.max;
  json["lookups_per_frame"] = s.lookups_per_frame;
  return json;
}

}  // namespace

Json trackingJson(const TrackingReport& r) {
  const TrackingSuiteOptions& o = r.options;
  Json json = {
      {"suite", "tracking"},
      {"device", {{"name", r.device.name}, {"driver", r.device.driver}, {"type", toString(r.device.type)}}},
      {"settings", o.settings_name},
      {"generated",
       {{"first_seed", o.first_seed},
        {"rooms", o.rooms},
        {"meshes", o.mesh_folder.string()},
        {"frames", o.synth.frames},
        {"max_speed_mps", o.synth.linear.high},
        {"max_angular_radps", o.synth.angular.high},
        {"noise", toString(o.synth.noise)}}},
      {"stride", o.stride},
      {"interrupted", r.interrupted}};
  json["sequences"] = Json::array();
  for (const TrackedSequence& s : r.sequences) json["sequences"].push_back(toJson(s));
  const ErrorSummary ate = r.ateOfSequences();
  json["summary"] = {{"sequences", r.sequences.size()},
                     {"within_3cm", r.goodSequences()},
                     {"ate_rmse_mean_m", ate.mean},
                     {"ate_rmse_worst_m", ate.max},
                     {"judged_frames", r.total(&TrackedSequence::frames)},
                     {"good_frames", r.total(&TrackedSequence::good_frames)},
                     {"uncertain", r.total(&TrackedSequence::uncertain)},
                     {"frames_without_pose", r.total(&TrackedSequence::lost)}};
  return json;
}

std::string trackingHead(const DeviceInfo& device) {
  return device.name + ", " + device.driver + "\n" +
         printed("%-24s %9s %9s %9s %7s %9s %6s %9s %9s\n", "sequence", "ATE cm", "worst cm", "TE cm",
                 "frames", "uncertain", "lost", "ms/frame", "lookups");
}

std::string trackingRow(const TrackedSequence& s) {
  std::string back;
  if (s.recovery) {
    const Recovery& r = *s.recovery;
    back = !r.possible ? "  view never returns"
           : r.frames == Recovery::kNever
               ? "  never back"
               : printed("  back after %zu, ends %.2f cm off", r.frames, 100 * r.final_error_m);
    if (r.wrongly_fused) back += printed(", %zu fused wrongly", r.wrongly_fused);
  }
  return printed("%-24.24s %9.2f %9.2f %9.2f %7zu %9zu %6zu %9.1f %8.2fM%s%s\n", s.name.c_str(),
                 100 * s.ate_m.rmse, 100 * s.ate_m.max, 100 * s.te_m.rmse, s.frames, s.uncertain, s.lost,
                 s.ms_per_frame, 1e-6 * s.lookups_per_frame, back.c_str(), s.good() ? "" : "  FAILED");
}

std::string trackingSummary(const TrackingReport& r) {
  const ErrorSummary ate = r.ateOfSequences();
  const std::size_t lost = r.total(&TrackedSequence::lost);
  std::string out =
      printed("%zu of %zu sequences with every frame within 3 cm; %zu of %zu frames within 3 cm, %zu lost.\n",
              r.goodSequences(), r.sequences.size(), r.total(&TrackedSequence::good_frames),
              r.total(&TrackedSequence::frames), lost);
  out += printed("ATE (RMSE after alignment): mean %.2f cm, worst %.2f cm%s.\n", 100 * ate.mean,
                 100 * ate.max, lost ? ", the lost frames left out" : "");
  return out;
}

}  // namespace rosefusion
