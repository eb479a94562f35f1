#include "host/datasets/text_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"

namespace rosefusion::datasets {

TextTable readTextTable(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError(file.string() + ": cannot be opened; check that it is a readable file.");
  TextTable table;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    TextRow row{number, {}};
    for (std::string field; fields >> field;) row.fields.push_back(field);
    if (row.fields.empty()) continue;
    if (row.fields[0][0] == '#')
      table.comments += line + '\n';
    else
      table.rows.push_back(std::move(row));
  }
  return table;
}

bool parseNumber(const std::string& field, double& value) {
  const std::optional<double> number = rosefusion::parseNumber(field);
  value = number.value_or(0);
  return number.has_value();
}

std::optional<std::string> digitsBetween(const std::string& name, std::string_view prefix,
                                         std::string_view suffix) {
  constexpr std::size_t kMostDigits = 9;  // fits an int
  if (!name.starts_with(prefix) || !name.ends_with(suffix) || name.size() <= prefix.size() + suffix.size())
    return std::nullopt;
  const std::string digits = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  if (digits.size() > kMostDigits || digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return digits;
}

std::vector<double> readNumbers(const std::filesystem::path& file) {
  std::vector<double> numbers;
  for (const TextRow& row : readTextTable(file).rows)
    for (const std::string& field : row.fields) {
      numbers.emplace_back();
      if (!parseNumber(field, numbers.back()))
        throw InputError(file.string() + ":" + std::to_string(row.line) + ": '" + field +
                         "' is not a number; correct the file.");
    }
  return numbers;
}

std::vector<StampedFile> readStampedFiles(const std::filesystem::path& list,
                                          std::vector<std::string>& warnings) {
  std::vector<StampedFile> files;
  std::size_t skipped = 0;
  std::string first;
  for (const TextRow& row : readTextTable(list).rows) {
    double stamp = 0;
    std::string name;
    for (std::size_t i = 1; i < row.fields.size(); ++i) name += (i > 1 ? " " : "") + row.fields[i];
    const bool named = row.fields.size() == 2 ||
                       (row.fields.size() > 2 && std::filesystem::exists(list.parent_path() / name));
    if (named && parseNumber(row.fields[0], stamp) && std::isfinite(stamp)) {
      files.push_back({stamp, name});
    } else if (skipped++ == 0) {
      first = "line " + std::to_string(row.line) + " is not 'timestamp file'";
    }
  }
  if (files.empty())
    throw InputError(list.string() +
                     ": lists no images; each line should read 'timestamp file' with the time in seconds.");
  if (skipped > 0) warnings.push_back(skippedLines(list, skipped, first));
  return files;
}

std::string skippedLines(const std::filesystem::path& list, std::size_t count, const std::string& first) {
  return list.string() + ": " + std::to_string(count) + (count == 1 ? " line" : " lines") + " skipped (" +
         first + ").";
}

}  // namespace rosefusion::datasets
