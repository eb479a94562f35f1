#include "host/experiments/quoted.h"
#include "host/core/number_text.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

namespace rosefusion {

extern const char* const kQuotedFiguresCsv;

const std::vector<QuotedFigure>& quotedFigures() {
  static const std::vector<QuotedFigure> all = [] {
    std::vector<QuotedFigure> figures;
    std::istringstream lines(kQuotedFiguresCsv);
    std::string line;
    std::getline(lines, line);  // the head
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      QuotedFigure f;
      std::string value;
      for (std::string* cell : {&f.label, &f.sequence, &f.system, &f.quantity, &f.unit, &value})
        std::getline(cells, *cell, ',');
      f.value = value == "failed" ? std::numeric_limits<double>::quiet_NaN() : parseNumber(value).value();
      figures.push_back(f);
    }
    return figures;
  }();
  return all;
}

Table quotedTable(const std::string& label) {
  Table table({"label", "sequence", "system", "quantity", "unit", "value", "source"});
  for (const QuotedFigure& f : quotedFigures())
    if (f.label == label)
      table.add({f.label, f.sequence, f.system, f.quantity, f.unit,
                 std::isnan(f.value) ? Cell("failed") : Cell(f.value), "quoted from the paper"});
  return table;
}

std::string quotedMeans(const std::string& label) {
  struct Sum {
    double total = 0;
    int count = 0, failed = 0;
    std::string unit;
  };
  std::map<std::string, Sum> sums;
  for (const QuotedFigure& f : quotedFigures()) {
    if (f.label != label) continue;
    Sum& sum = sums[f.quantity == "ATE mean" ? f.system : f.system + " " + f.quantity];
    sum.unit = f.unit;
    if (std::isnan(f.value)) {
      ++sum.failed;
    } else {
      sum.total += f.value;
      ++sum.count;
    }
  }
  std::string text;
  for (const auto& [system, sum] : sums) {
    if (!text.empty()) text += ", ";
    text += sum.count > 0 ? fmt::format("{} {:.1f} {}", system, sum.total / sum.count, sum.unit)
                          : system + " none";
    if (sum.failed > 0) text += fmt::format(" ({} failed)", sum.failed);
  }
  return text;
}

}  // namespace rosefusion
