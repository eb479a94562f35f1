#include "host/datasets/association.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/core/error.h"
#include "host/core/number_text.h"
#include "host/datasets/image_file.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

bool mentionsDepth(const std::string& path) {
  return lowered(path).find("depth") != std::string::npos;
}

bool isDepthImage(const std::filesystem::path& file) {
  cv::Mat image;
  std::string problem;
  return readDepthImage(file, {}, image, problem);
}

}  // namespace

std::vector<std::optional<std::size_t>> associateNearest(const std::vector<double>& from,
                                                         const std::vector<double>& to,
                                                         double max_difference) {
  std::vector<std::size_t> order(to.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return to[a] < to[b]; });
  std::vector<std::optional<std::size_t>> nearest(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto after = std::lower_bound(order.begin(), order.end(), from[i],
                                        [&](std::size_t index, double time) { return to[index] < time; });
    double best = max_difference;
    for (auto candidate : {after, after == order.begin() ? after : after - 1}) {
      if (candidate == order.end() || std::abs(to[*candidate] - from[i]) > best) continue;
      best = std::abs(to[*candidate] - from[i]);
      nearest[i] = *candidate;
    }
  }
  return nearest;
}

std::filesystem::path findAssociationFile(const std::filesystem::path& folder) {
  for (const char* name : {"associations.txt", "associated.txt", "associate.txt", "association.txt"})
    if (std::filesystem::is_regular_file(folder / name)) return folder / name;
  return {};
}

Associations readAssociations(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  std::vector<TextRow> rows = readTextTable(file).rows;
  std::string first;
  const auto malformed = [&](const TextRow& row) {
    double a = 0, b = 0;
    const bool good = row.fields.size() == 4 && parseNumber(row.fields[0], a) &&
                      parseNumber(row.fields[2], b) && std::isfinite(a) && std::isfinite(b);
    if (!good && first.empty())
      first = "line " + std::to_string(row.line) + " is not 'timestamp file timestamp file'";
    return !good;
  };
  const std::size_t skipped = std::erase_if(rows, malformed);
  if (rows.empty())
    throw InputError(file.string() +
                     ": lists no images; each line should read 'timestamp file timestamp file'.");
  if (skipped > 0) warnings.push_back(skippedLines(file, skipped, first));

  const std::filesystem::path folder = file.parent_path();
  const std::string &left = rows[0].fields[1], &right = rows[0].fields[3];
  bool left_is_depth = mentionsDepth(left), right_is_depth = mentionsDepth(right);
  if (left_is_depth == right_is_depth) {
    left_is_depth = isDepthImage(folder / left);
    right_is_depth = isDepthImage(folder / right);
  }
  if (left_is_depth == right_is_depth)
    throw InputError(file.string() +
                     ": cannot tell which column is the depth image; put the images in folders named "
                     "'depth' and 'rgb'.");
  Associations result;
  result.depth_first = left_is_depth;
  const std::size_t d = left_is_depth ? 0 : 2, c = 2 - d;
  for (const TextRow& row : rows) {
    FrameFiles frame{0, folder / row.fields[d + 1], folder / row.fields[c + 1]};
    parseNumber(row.fields[d], frame.timestamp);
    result.frames.push_back(std::move(frame));
  }
  return result;
}

bool stampsAreFrameNumbers(const std::vector<FrameFiles>& frames) {
  const auto whole = [](const FrameFiles& f) { return f.timestamp == std::floor(f.timestamp); };
  return frames.size() > 1 && std::all_of(frames.begin(), frames.end(), whole) &&
         std::abs(frames.back().timestamp - frames.front().timestamp) <
             10.0 * static_cast<double>(frames.size());
}

}  // namespace rosefusion::datasets
