#include "host/experiments/table.h"
#include "host/core/number_text.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace rosefusion {

namespace {

std::string doubled(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, "\"");
  return text;
}

}  // namespace

Cell::Cell(double value) {
  text = std::isnan(value) ? "nan" : printed("%.6g", value);  // printf may write -nan
}

void Table::add(std::initializer_list<Cell> row) {
  if (row.size() != columns_.size()) throw std::invalid_argument("a row needs one cell for each column");
  auto& cells = rows_.emplace_back();
  for (const Cell& cell : row) cells.push_back(cell.text);
}

std::string Table::text(char separator, bool head) const {
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) out += separator;
      // Only a word can hold what would break the row; sentences in CSV are quoted as RFC 4180 says.
      const bool quoted = cells[i].find_first_of(head ? ",\"" : " ") != std::string::npos;
      if (!quoted)
        out += cells[i];
      else
        out += '"' + doubled(cells[i]) + '"';
    }
    out += '\n';
  };
  if (head) line(columns_);
  for (const auto& row : rows_)
    if (!row.empty() || !head) line(row);
  return out;
}

}  // namespace rosefusion
