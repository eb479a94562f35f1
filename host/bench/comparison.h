// Two sets of figures of the passes, side by side.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rosefusion {

struct ComparedFigure {
  std::string name;  ///< such as "raycast ms"
  double before = 0, after = 0;
  double ratio = 0;  ///< after / before
};

struct FiguresComparison {
  std::string before, after;            ///< device, driver, processor, commit and date of each
  std::vector<ComparedFigure> figures;  ///< the largest change first
  std::vector<std::string> remarks;     ///< what does not compare, a sentence each
};

/// Of what benchJson() gave, as datedFigures() completes it; `before_name`: of the file, for errors. Throws
/// InputError where one of them holds no figures of passes, or other work was measured: other settings,
/// frames or voxels.
FiguresComparison compareFigures(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                                 const std::string& before_name, const std::string& after_name);

nlohmann::ordered_json comparisonJson(const FiguresComparison& comparison);
/// A table for people.
std::string comparisonTable(const FiguresComparison& comparison);

}  // namespace rosefusion
