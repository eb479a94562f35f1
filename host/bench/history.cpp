#include "host/bench/history.h"

#include <charconv>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/core/system.h"
#include "host/core/text_file.h"

namespace rosefusion {

extern const char* const kCommit;  // cmake/commit.cmake

namespace {

using Json = nlohmann::ordered_json;

std::string now() {
  using namespace std::chrono;
  const auto time = floor<seconds>(system_clock::now());
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(time - day);
  return printed("%04d-%02u-%02uT%02d:%02d:%02dZ", int(date.year()), unsigned(date.month()),
                 unsigned(date.day()), int(clock.hours().count()), int(clock.minutes().count()),
                 int(clock.seconds().count()));
}

/// The N of FILE#N, whose name is then FILE; 0: none, or a file is called so.
long entryNumber(std::string& name) {
  const std::size_t at = name.rfind('#');
  std::error_code error;
  if (at == name.npos || std::filesystem::exists(name, error)) return 0;
  long number = 0;
  const char *begin = name.data() + at + 1, *end = name.data() + name.size();
  const auto [stop, code] = std::from_chars(begin, end, number);
  if (code != std::errc() || stop != end || number == 0)
    throw InputError(name +
                     ": what follows '#' is no entry of a history; give 1 for its first or -1 for its last.");
  name.resize(at);
  return number;
}

std::vector<Json> entriesOf(const std::string& file) {
  const std::string text = readTextFile(file);
  if (Json whole = Json::parse(text, nullptr, false); whole.is_object()) return {whole};
  std::vector<Json> entries;
  for (std::size_t begin = 0, line = 1; begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string row = text.substr(begin, end - begin);
    begin = end + 1;
    if (row.find_first_not_of(" \t\r") == row.npos) continue;
    Json entry = Json::parse(row, nullptr, false);
    if (!entry.is_object())
      throw InputError(file + ": line " + std::to_string(line) +
                       " is no JSON object; give a file that bench wrote with --json or --history.");
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

std::string programCommit() {
  return kCommit;
}

Json datedFigures(const Json& figures) {
  Json out = {{"date", now()}, {"commit", programCommit()}, {"processor", processorName()}};
  out.update(figures);
  return out;
}

void appendHistory(const std::filesystem::path& file, const Json& entry) {
  if (const int code = appendLine(file, entry.dump()))
    throw InputError(file.string() + ": cannot be appended to (" + std::strerror(code) +
                     "); check its permissions and the disk, or choose another file.");
}

Json readFigures(const std::string& place) {
  std::string file = place;
  const long number = entryNumber(file);
  const std::vector<Json> entries = entriesOf(file);
  const long count = static_cast<long>(entries.size());
  const long index = number > 0 ? number - 1 : number < 0 ? count + number : count - 1;
  if (index < 0 || index >= count)
    throw InputError(place + ": there " +
                     (count == 1 ? "is 1 entry" : "are " + std::to_string(count) + " entries") +
                     "; choose one of them.");
  return entries[static_cast<std::size_t>(index)];
}

}  // namespace rosefusion
