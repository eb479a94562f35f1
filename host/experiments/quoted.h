// Figures of the paper's tables, quoted to stand beside ours: facts, with the label of the table each is
// from.
#pragma once
#include <string>
#include <vector>

#include "host/experiments/table.h"

namespace rosefusion {

struct QuotedFigure {
  std::string label;  ///< of the table in the paper's source, such as "tab:comp-icl"
  std::string sequence, system, quantity, unit;
  double value = 0;  ///< NaN where the paper says that tracking failed
};

/// All of quoted_figures.csv.
const std::vector<QuotedFigure>& quotedFigures();

/// Those of one table, as rows marked "quoted".
Table quotedTable(const std::string& label);
/// Their means by system and quantity, over what did not fail: "A 1.2 cm, B 3.4 cm".
std::string quotedMeans(const std::string& label);

}  // namespace rosefusion
