// The tables behind the plots: what a test or another program reads.
#pragma once
#include <initializer_list>
#include <string>
#include <vector>

namespace rosefusion {

/// A number with six significant digits ("nan" where there is none), or a word.
struct Cell {
  std::string text;
  Cell(double value);  // NOLINT: rows are written as lists of values
  Cell(const std::string& word) : text(word) {}
  Cell(const char* word) : text(word) {}
};

class Table {
 public:
  /// Column names with their units, such as "ate_mean_cm".
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  /// One cell a column.
  void add(std::initializer_list<Cell> row);
  /// An empty row: a gap in a line that gnuplot draws through the rows.
  void addGap() { rows_.emplace_back(); }
  std::string csv() const { return text(',', true); }
  /// For gnuplot: separated by spaces, words quoted, no head.
  std::string plotData() const { return text(' ', false); }

 private:
  std::string text(char separator, bool head) const;

  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace rosefusion
