#include "host/datasets/text_table.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/text_file.h"

namespace rosefusion::datasets {

TextTable readTextTable(const std::filesystem::path& file) {
  constexpr const char* kSeparators = " \t,\f\v";
  std::istringstream in(readTextFile(file));
  TextTable table;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    TextRow row{number, {}, line, {}};
    for (std::size_t at = 0; (at = line.find_first_not_of(kSeparators, at)) != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(kSeparators, at), line.size());
      row.fields.push_back(line.substr(at, end - at));
      row.begins.push_back(at);
      at = end;
    }
    if (row.fields.empty()) continue;
    if (row.fields[0][0] == '#')
      table.comments += line + '\n';
    else
      table.rows.push_back(std::move(row));
  }
  return table;
}

std::string TextRow::span(std::size_t first, std::size_t last) const {
  const std::size_t begin = begins[first], end = begins[last] + fields[last].size();
  std::string name = text.substr(begin, end - begin);
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  std::replace(name.begin(), name.end(), '\\', '/');  // of lists that were made on Windows
  return name;
}

bool isHidden(const std::filesystem::path& file) {
  return file.filename().string().starts_with('.');
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
    const std::string name = row.fields.size() > 1 ? row.span(1, row.fields.size() - 1) : "";
    const bool named = row.fields.size() == 2 ||
                       (row.fields.size() > 2 && std::filesystem::exists(list.parent_path() / name));
    if (named && isHidden(name)) continue;  // a list that was made of all files of a folder
    if (named && parseNumber(row.fields[0], stamp) && std::isfinite(stamp)) {
      files.push_back({stamp, name});
    } else if (skipped++ == 0) {
      first = "line " + std::to_string(row.line) + " is not 'timestamp file'";
    }
  }
  if (files.empty())
    throw InputError(list.string() +
                     ": lists no images; each line should read 'timestamp file' with the time in seconds "
                     "(with a decimal point).");
  if (skipped > 0) warnings.push_back(skippedLines(list, skipped, first));
  return files;
}

std::string skippedLines(const std::filesystem::path& list, std::size_t count, const std::string& first) {
  return list.string() + ": " + std::to_string(count) + (count == 1 ? " line" : " lines") + " skipped (" +
         first + ").";
}

}  // namespace rosefusion::datasets
