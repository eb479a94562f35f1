#include "host/datasets/numbered_files.h"

#include <algorithm>
#include <initializer_list>
#include <string>

#include "host/core/number_text.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;
using Endings = std::initializer_list<const char*>;

constexpr Endings kDepthEndings = {".png", ".tiff", ".tif", ".exr", ".npy"};
constexpr Endings kColourEndings = {".jpg", ".jpeg", ".png"};

bool isDigits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::optional<NumberedFile> numbered(const fs::path& file, Endings endings) {
  const std::string ending = lowered(file.extension().string());
  if (std::none_of(endings.begin(), endings.end(), [&](const char* known) { return ending == known; }))
    return {};
  const std::string stem = file.stem().string();
  const std::size_t dash = stem.find('-');
  const auto number = digitsBetween(stem.substr(0, dash), "", "");
  if (!number) return {};
  NumberedFile out{std::stoi(*number), {}, file};
  if (dash == stem.npos) return out;
  const std::string microseconds = stem.substr(dash + 1);
  if (!isDigits(microseconds) || microseconds.size() > 18) return {};
  out.seconds = 1e-6 * static_cast<double>(std::stoll(microseconds));
  return out;
}

std::vector<NumberedFile> numberedFiles(const fs::path& folder, Endings endings) {
  std::vector<NumberedFile> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (auto file = numbered(entry.path(), endings)) files.push_back(std::move(*file));
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
    return a.number != b.number ? a.number < b.number : a.path < b.path;
  });
  files.erase(std::unique(files.begin(), files.end(),
                          [](const auto& a, const auto& b) { return a.number == b.number; }),
              files.end());
  return files;
}

}  // namespace

std::vector<NumberedFile> numberedDepth(const fs::path& folder) {
  return numberedFiles(folder, kDepthEndings);
}

std::vector<NumberedFile> numberedColour(const fs::path& folder) {
  return numberedFiles(folder, kColourEndings);
}

bool hasNumberedDepth(const fs::path& folder) {
  std::error_code ignored;
  const fs::directory_iterator files(folder, ignored);
  return std::any_of(begin(files), end(files),
                     [](const auto& entry) { return numbered(entry.path(), kDepthEndings).has_value(); });
}

}  // namespace rosefusion::datasets
