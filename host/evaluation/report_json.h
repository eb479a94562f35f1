// Evaluation results as JSON: the names every report of this project uses for them.
#pragma once
#include <nlohmann/json.hpp>

#include "host/evaluation/mesh_error.h"
#include "host/evaluation/trajectory_error.h"

namespace rosefusion {

/// ate_rmse_m, ate_mean_m, te_rmse_m, te_under_5cm and so on; figures that could not be measured are null.
nlohmann::ordered_json toJson(const TrajectoryErrors& errors);

/// accuracy_rms_m, completeness_5cm, f_score_5cm and so on; figures that could not be measured are null.
nlohmann::ordered_json toJson(const MeshErrors& errors);

}  // namespace rosefusion
