#include "host/evaluation/report_json.h"
#include "host/core/number_text.h"

#include <sstream>
#include <string>

namespace rosefusion {
namespace {

using Json = nlohmann::ordered_json;

/// A threshold as it appears in names: 0.05 -> "5cm".
std::string centimetres(double threshold_m) {
  TextStream text;
  text << threshold_m * 100 << "cm";
  return text.str();
}

void add(Json& json, const std::string& name, const ErrorSummary& summary, const std::string& unit) {
  json[name + "_rmse_" + unit] = summary.rmse;
  json[name + "_mean_" + unit] = summary.mean;
  json[name + "_median_" + unit] = summary.median;
  json[name + "_max_" + unit] = summary.max;
}

}  // namespace

Json toJson(const TrajectoryErrors& errors) {
  Json json;
  json["frames"] = errors.frames;
  json["lost_frames"] = errors.lost_frames;
  json["frames_basis"] = errors.frames_basis;
  json["estimate_poses"] = errors.estimate_poses;
  json["truth_poses"] = errors.truth_poses;
  json["common_poses"] = errors.common_poses;
  json["association"] = errors.association;
  json["alignment"] = errors.alignment.description;
  Json& matrix = json["truth_from_estimate"] = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json values = Json::array();
    for (int column = 0; column < 4; ++column)
      values.push_back(errors.alignment.truth_from_estimate.matrix()(row, column));
    matrix.push_back(values);
  }
  add(json, "ate", errors.ate_m, "m");
  add(json, "te", errors.te_m, "m");
  for (std::size_t i = 0; i < kTeThresholds_m.size(); ++i)
    json["te_under_" + centimetres(kTeThresholds_m[i])] = errors.te_share[i];
  add(json, "rpe_frame", errors.rpe_frame_m, "m");
  add(json, "rpe_frame", errors.rpe_frame_deg, "deg");
  add(json, "rpe_second", errors.rpe_second_m, "m");
  add(json, "rpe_second", errors.rpe_second_deg, "deg");
  return json;
}

Json toJson(const MeshErrors& errors) {
  Json json;
  json["reconstruction_samples"] = errors.reconstruction_samples;
  json["truth_samples"] = errors.truth_samples;
  json["accuracy_rms_m"] = errors.accuracy_m.rmse;
  json["accuracy_mean_m"] = errors.accuracy_m.mean;
  json["accuracy_median_m"] = errors.accuracy_m.median;
  json["accuracy_max_m"] = errors.accuracy_m.max;
  json["inlier_limit_m"] = errors.inlier_m;
  json["inlier_accuracy_rms_m"] = errors.inlier_accuracy_m.rmse;
  for (const MeshScore& score : errors.scores) {
    const std::string at = centimetres(score.threshold_m);
    json["completeness_" + at] = score.completeness;
    json["precision_" + at] = score.precision;
    json["f_score_" + at] = score.f_score;
  }
  return json;
}

}  // namespace rosefusion
